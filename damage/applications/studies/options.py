"""The option --members of a run, whose members a study of one point makes."""

from damage.run.options import RUN_MEMBERS


def _run_members(*asked):
    """As `damage.applications.studies.members.run_members`, whose libraries no other run needs."""
    from damage.applications.studies.members import run_members

    return run_members(*asked)


RUN_MEMBERS.append(_run_members)
