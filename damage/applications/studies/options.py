"""The option --members of a run, whose members a study of one point makes, and what they say of its
scatter."""

from damage.run.options import RUN_MEMBERS, SUMMARY


def _run_members(*asked):
    """As `damage.applications.studies.members.run_members`, whose libraries no other run needs."""
    from damage.applications.studies.members import run_members

    return run_members(*asked)


def _spread(history):
    from damage.applications.studies.spread import members_of, spread

    table = members_of(history)
    return None if table is None else spread(table)


def _described(spread):
    from damage.applications.studies.spread import describe_spread

    return describe_spread(spread)


RUN_MEMBERS.append(_run_members)
SUMMARY["members"] = _spread, _described
