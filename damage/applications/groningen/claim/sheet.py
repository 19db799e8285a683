"""The sheet of a claim, HTML for both sides of an A4 sheet, in English or Dutch: the numbers of
`damage.applications.groningen.claim.numbers`, and pictures of the front."""

import os
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
from markupsafe import Markup

from damage.applications.groningen.claim.answer import (
    BUT_FOR,
    LEAST_DRAWS,
    MOST_OFF_JOINTS,
    ROWS,
    STRANGEST,
    WITHOUT,
)
from damage.applications.groningen.claim.numbers import (
    MOST_DRAWS,
    draws_needed,
    lacks_draws,
    largest_share,
)
from damage.applications.report.words import all_words, environment, number, of_hundred, words
from damage.index import THRESHOLD
from damage.measure.cracks import cracked, ends_of
from damage.measure.evidence import evidence_for
from damage.units import MILLIMETRE

NUMBERS = "claim.json"
"""File of the numbers."""
SHEET = "claim.html"
"""File of the sheet."""
FORMER = "former-"
"""Beginning of the names of files of an earlier command."""
LETTERS = 32
"""Size of the front over the height of letters in pictures."""
MARGIN_MM = 60
"""Margin of a picture, in millimetres of the wall."""
THINNEST_MM = 10
"""Width of the line of a crack of no width, in millimetres of the wall."""
DRAWN_MM = 40
"""Width that 1 mm of a crack adds to its line, in millimetres of the wall."""
_LIMITS = {
    "draws": (LEAST_DRAWS, 1),
    "strange": (100 * STRANGEST, 100),
    "off_joints": (100 * MOST_OFF_JOINTS, 100),
    "small": (THRESHOLD / MILLIMETRE, 1),
}
"""{code of `damage.applications.groningen.claim.answer.reasons`: (limit as it is shown, factor by
which values are shown)}."""


def set_aside(out):
    """Rename the sheet and the numbers of an earlier command in a folder, so that those of this one
    are not there before it has made them, whatever ends it."""
    for name in (SHEET, NUMBERS):
        with suppress(OSError):
            os.replace(Path(out) / name, Path(out) / f"{FORMER}{name}")


def sheet(numbers, wall, survey, twins, language, json_name):
    """The text of the sheet; numbers: of `numbers_of`; wall: Layout; survey: Survey; json_name:
    file of all numbers."""
    say = partial(words, language)
    shown = partial(number, language)
    made_by = numbers["made_by"]
    draws = made_by["draws"]

    def ranges(three):
        if not three:
            return "-"
        least, middle, most = (shown(round(value, 2) + 0.0) for value in three)
        return Markup("{}<small>{}</small>").format(middle, say("range", least=least, most=most))

    return (
        environment()
        .get_template("claim.html")
        .render(
            numbers=numbers,
            words=say,
            shown=shown,
            language=language,
            cell=of_hundred,
            ranges=ranges,
            **in_words(numbers, language),
            rows=ROWS,
            but_for=BUT_FOR,
            without=WITHOUT,
            pictures=_pictures(numbers, wall, survey, twins, language),
            taken=_taken(numbers, say, shown),
            evidence=_evidence(numbers["evidence"], language),
            json_name=json_name,
            software=(
                f"masonry-damage {made_by['software']}, commit {made_by['commit']}; draws: commit"
                f" {draws['commit']}, model {draws['model_digest']}, measures"
                f" {draws['measures_digest']}"
            ),
        )
    )


def in_words(numbers, language="en"):
    """{"answer": sentences of the verdict, "why": sentences on why there is none, empty where there
    is one, "helps": what would give one}, lists."""
    say = partial(words, language)
    shown = partial(number, language)
    why = []
    for reason in numbers["no_answer"]:
        limit, factor = _LIMITS[reason["why"]]
        value = _beyond(factor * reason["value"], limit, shown)
        why.append(say(f"why_{reason['why']}", value=value, limit=shown(limit)))
    return {
        "answer": _answer(numbers, say, shown),
        "why": why,
        "helps": [say(f"help_{help_}") for help_ in _helps(numbers)],
    }


def whether_more_draws_help(numbers, language):
    """A sentence on what more draws would give, None where an answer does not lack them."""
    say = partial(words, language)
    shown = partial(number, language)
    if not numbers["no_answer"]:
        return None
    if not lacks_draws(numbers):
        return say("more_no")
    needed = draws_needed(numbers)
    if np.isfinite(needed):
        return say("more_in_proportion", n=shown(needed), limit=LEAST_DRAWS)
    share = largest_share(numbers["draws"])
    most = numbers["draws_to_come"] or MOST_DRAWS
    return say(
        "more_of_none",
        can=say("more_can" if share * most >= LEAST_DRAWS else "more_cannot"),
        n=numbers["draws"],
        nearest=shown(min((life["distance"] for life in numbers["nearest"]), default=None)),
        farthest=shown(numbers["farthest"]),
        share=shown(100 * share),
        most=most,
        limit=LEAST_DRAWS,
    )


def _beyond(value, limit, shown):
    """A value in as many digits, two or more, as tell it from its limit."""
    texts = (shown(value, digits) for digits in range(2, 10))
    return next((text for text in texts if text != shown(limit)), shown(value))


def _helps(numbers):
    """Codes of what would give an answer where a question is open."""
    open_why = {entry["why"] for entry in numbers["no_answer"]}
    if not open_why and "open" not in numbers["verdict"].values():
        return []
    survey = numbers["survey"]
    helps = {
        "front": bool(open_why & {"strange", "off_joints"}),
        "levels": "drawn" in numbers["settlement"],
        "limit": not survey["detection_limit_known"],
    }
    return [name for name, applies in helps.items() if applies]


def _answer(numbers, say, shown):
    """Sentences of the verdict, a list; the last is what the earthquakes added by the draws like
    the survey, over all priors."""
    sentences = []
    for name in BUT_FOR:
        shares = [
            100 * entry[name]["share"]
            for entry in numbers["like_survey"].values()
            if entry[name]["share"] is not None
        ]
        ends = sorted({round(min(shares)), round(max(shares))}) if shares else []
        ranges = "-".join(map(str, ends)) or "-"
        sentences.append(say(f"{name}_{numbers['verdict'][name]}", ranges=ranges))
    added = [
        entry["like_survey"]["added"]
        for entry in numbers["crack_width_mm"].values()
        if entry["like_survey"]["added"]
    ]
    if added:
        least, most = (
            round(width, 2) + 0.0
            for width in (min(width[0] for width in added), max(width[2] for width in added))
        )
        sentences.append(
            say(
                "added_width" if least >= 0 else "changed_width",
                least=shown(least),
                most=shown(most),
                now=shown(numbers["survey"]["max_width_mm"]),
            )
        )
    return sentences


def _taken(numbers, say, shown):
    """Sentences on what was taken for the ground, the draws, their records, the front and the
    survey, a list."""
    given = numbers["settlement"]
    survey = numbers["survey"]
    if "drawn" in given:
        least, most = (round(1 / distance) for distance in given["distortion"])
        ground = say("settled_drawn", least=least, most=most)
    elif given["distortion"]:
        ground = say(
            "settled_given",
            profile=say(f"profile_{given['profile']}"),
            distortion=round(1 / given["distortion"]),
        )
    else:
        ground = say("settled_file", profile=given["profile"])
    strong = numbers["choices"].get("strong")
    along, up = numbers["choices"].get("units", (1, 1))
    looked_at = survey["share_looked_at"]
    sentences = [
        ground,
        say(
            "draws",
            n=numbers["draws"],
            events=shown(numbers["events_per_draw"]),
            above=shown(numbers["choices"]["above_mm_s"]),
            kernel=shown(numbers["kernel"]),
            farthest=shown(numbers["farthest"]),
            fell=numbers["fell"]["earthquakes"],
            fell_settled=numbers["fell"]["both"],
        ),
        any(strong or ())
        and say("windows", first=shown(100 * strong[0]), last=shown(100 - 100 * strong[1])),
        not along == up == 1 and say("units", along=along, up=up),
        looked_at != 1 and say("looked_at", share=round(100 * looked_at)),
        say("widths_used"),
        say(
            "detection",
            limit=shown(survey["detection_limit_mm"]),
            error=shown(survey["width_error_mm"]),
        ),
        say("offsets_yes" if survey["offsets_known"] else "offsets_no"),
    ]
    return list(filter(None, sentences))


def outside_at_rest(wall, language):
    """A sentence on what of the front, a Layout, lies outside the range of validity, whatever
    shakes it."""
    given = {"loading": {"kind": "none"}, "pier_stress_pa": wall.pier_stress}
    evidence = evidence_for(wall.wall, given)
    for quantity in evidence.values():
        quantity["outside_share"] = float(quantity["inside"] is False)
    return _evidence(evidence, language)


def _unit(unit, language):
    """A unit, in a language where it has words."""
    return all_words().get(unit, {}).get(language, unit)


def _evidence(evidence, language):
    """A sentence on which quantities lie outside the range of validity."""
    say = partial(words, language)
    shown = partial(number, language)
    outside = [
        say(
            "quantity_outside",
            name=say(f"quantity {name}"),
            range=say("range", least=shown(quantity["least"], 3), most=shown(quantity["most"], 3)),
            unit=quantity["unit"] and f" {_unit(quantity['unit'], language)}",
        )
        + (share < 1) * say("in_runs", share=shown(100 * share))
        for name, quantity in evidence.items()
        if (share := quantity["outside_share"]) > 0
    ]
    known = sum(quantity["inside"] is not None for quantity in evidence.values())
    return (
        say("outside", found=len(outside), known=known, names=", ".join(outside))
        if outside
        else say("inside", known=known)
    )


# --- pictures ------------------------------------------------------------------------------------


def _pictures(numbers, wall, survey, twins, language):
    """(SVG, caption) of the survey and of the nearest computed walls."""
    say = partial(words, language)
    shown = partial(number, language)
    survey_numbers = numbers["survey"]
    parts = survey.pattern.stretches
    caption = say(
        "survey_is",
        cracks=survey_numbers["cracks"],
        length=shown(survey_numbers["crack_length_m"]),
        width=shown(survey_numbers["max_width_mm"]),
        share=round(100 * survey_numbers["share_on_joints"]),
    )
    pictures = [
        (
            front(
                wall,
                ends_of(parts),
                parts["width_m"].to_numpy(float),
                colour="#b00",
                label=say("survey"),
                names=[
                    (f"{crack['crack']} {shown(crack['width_mm'])} mm", *crack["from_m"])
                    for crack in numbers["cracks"]
                ],
            ),
            f"{say('survey')}: {caption}",
        )
    ]
    for life in numbers["nearest"]:
        k = int(np.flatnonzero(twins.numbers == life["life"])[0])
        width = np.hypot(twins.opening_m[life["state"]][k], twins.offset_m[life["state"]][k])
        seen = cracked(width, survey.detection_limit_m)
        key = "nearest" if life["distance"] <= numbers["farthest"] else "nearest_unlike"
        text = say(key, cause=say(f"cause_{life['state']}"), distance=shown(life["distance"]))
        widest = np.argmax(width)
        label = f"{shown(width[widest] / MILLIMETRE)} mm", *twins.ends[widest][0]
        picture = front(
            wall,
            twins.ends[seen],
            width[seen],
            colour="#046",
            label=text,
            names=[label] if seen.any() else [],
        )
        pictures.append((picture, text))
    return pictures


def front(wall, ends, width_m, colour, label, names=()):
    """SVG of a Layout's bricks with cracks: ends (n, 2, 2) [m], width_m (n,); widths are drawn
    larger; names: (text, x, z) of labels."""
    bodies = wall.bodies
    n = wall.n_bricks
    length = wall.wall.length / MILLIMETRE
    height = wall.wall.built_height / MILLIMETRE

    def mm(value):
        return f"{value / MILLIMETRE:.0f}"

    bricks = "".join(
        f"M{mm(x - a / 2)} {mm(wall.wall.built_height - z - b / 2)}h{mm(a)}v{mm(b)}h-{mm(a)}z"
        for x, z, a, b in zip(
            *(getattr(bodies, name)[:n] for name in ("x", "z", "length", "height"))
        )
    )
    lines = "".join(
        f'<path d="M{mm(a[0])} {mm(wall.wall.built_height - a[1])}L{mm(b[0])}'
        f' {mm(wall.wall.built_height - b[1])}"'
        f' stroke-width="{THINNEST_MM + DRAWN_MM * min(w / MILLIMETRE, 2.0):.0f}"/>'
        for (a, b), w in zip(ends, width_m)
    )
    texts = "".join(
        f'<text x="{mm(x)}" y="{mm(wall.wall.built_height - z)}" dy="-.4em"'
        f' text-anchor="{"end" if 2 * x > wall.wall.length else "start"}">'
        f"{Markup.escape(text)}</text>"
        for text, x, z in names
    )
    box = f"{-MARGIN_MM} {-MARGIN_MM} {length + 2 * MARGIN_MM:.0f} {height + 2 * MARGIN_MM:.0f}"
    return Markup(
        f'<svg viewBox="{box}" font-size="{max(length, height) / LETTERS:.0f}" role="img"'
        f' aria-label="{Markup.escape(label)}"><path class="bricks"'
        f' d="{bricks}"/><path class="ground" d="M{-MARGIN_MM}'
        f' {height:.0f}h{length + 2 * MARGIN_MM:.0f}"/><g stroke="{colour}">{lines}</g>'
        f"{texts}</svg>"
    )
