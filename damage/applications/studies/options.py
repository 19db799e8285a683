"""The option --members of a run, whose members a study of one point makes, and what they say of its
scatter."""

from damage.applications.studies.spread import describe_spread, spread_of
from damage.run.options import RUN_MEMBERS, SUMMARY


def _run_members(*asked):
    """As `damage.applications.studies.members.run_members`, whose libraries no other run needs."""
    from damage.applications.studies.members import run_members

    return run_members(*asked)


RUN_MEMBERS.append(_run_members)
SUMMARY["members"] = spread_of, describe_spread
