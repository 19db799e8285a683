"""What a claim says in the terminal: before its runs how large they are, and in the end its
answer."""

from damage.applications.groningen.claim.answer import LEAST_DRAWS, WITHOUT, reasons
from damage.applications.groningen.claim.numbers import MOST_DRAWS
from damage.applications.groningen.claim.sheet import in_words
from damage.applications.report.words import words
from damage.applications.studies.cost import size_of as size_of_run


def no_answer_foreseen(survey, most):
    """Sentences on what forbids an answer whatever the runs give; most: draws that are asked
    for."""
    sentences = {
        "draws": (
            f"--draws {most}: the sheet will have no answer, for which {LEAST_DRAWS} draws have to"
            f" resemble the survey; leave --draws out for up to {MOST_DRAWS}"
        ),
        "off_joints": (
            "the sheet will have no answer: more than a fifth of the drawn length lies on no joint"
        ),
        "small": "the sheet will have no answer: no surveyed crack is wide enough to be visible",
    }
    return [sentences[why] for why, _ in reasons(survey.as_dict(), most, 0.0)]


def state_runs(study, steps):
    """Print the size of the first draws, and of the most that may follow, before anything
    starts."""
    size = "expected: {contact_points} contact points x {steps:.2g} steps".format(**size_of(study))
    print(
        *(
            f"{size} x {draws} draws"
            for draws in dict.fromkeys((steps[min(1, len(steps) - 1)], steps[-1]))
        ),
        f"An answer needs {LEAST_DRAWS} draws that resemble the survey.  The same command continues"
        " after an interruption.",
        sep="\n",
        flush=True,
    )


def size_of(study):
    """{"contact_points" of the wall, "steps" of a draw by both of its runs} of a claim's study."""
    points, steps, _ = zip(*(size_of_run(run) for run in study.runs if run.offset == 0))
    return {"contact_points": points[0], "steps": sum(steps)}


def _crack_in_words(crack):
    """A line on a crack of `damage.applications.groningen.claim.answer.of_cracks`."""
    cases = (
        f"{case.replace('_', ' ')}: {words('en', 'there_' + crack[case]['said'])}"
        for case in WITHOUT
    )
    return f"crack {crack['crack']} ({crack['width_mm']:.2g} mm) would be there " + ", ".join(cases)


def describe(numbers, language="en"):
    """The answer in a few lines of text, its sentences in a language."""
    lines = [
        f"{numbers['draws']} draws, effective number by priors of settlement "
        + ", ".join(f"{prior}: {value:.0f}" for prior, value in numbers["effective_draws"].items())
    ]
    sentences = in_words(numbers, language)
    lines += [f"no answer: {reason}" for reason in sentences["why"]] or [
        *sentences["answer"],
        *map(_crack_in_words, numbers["cracks"]),
    ]
    lines += [f"would help: {sentence}" for sentence in sentences["helps"]]
    return "\n".join(filter(None, [*lines, numbers["more_draws"]]))
