"""Processor time of the tests by subject and file, that of the programs they start included.

    bash tests/run.sh -p tests.processor_time

A plugin of pytest.  What a fixture of a module takes counts for the module; what takes most is named.
"""

import os
from collections import Counter

import pytest

SUBJECTS = {
    "batches": "batch combinations ensembles paper plan servers slurm study study_export study_figures "
               "study_schema validity outdated claim",
    "pictures and documents": "app app_browser dictionary documented_rows documents examples guides html "
                              "html_browser model_pictures paraview pictures programs site_browser",
    "model and solver": "after_peak any_wall as_built before bits brick_stress cells checkpoint columns "
                        "crack_file cracks crushing curves damping deformable draws elementary ends evidence "
                        "exposure fields floors "
                        "fragility grid history hysteresis intensity joint_law joint_stress joint_tracker layout "
                        "life limit_analysis lintel lintels loading loose lourenco mass_scaling measures members "
                        "model_options modes new_contacts offset outlines own_law "
                        "plausible random_runs ranges rounded records reference restraints run "
                        "run_constants run_warnings sampling sequence settlement shaken softening soil "
                        "survey synthetic text_records together verification wall_data wall_plan widths yade_ends "
                        "yade_falls yade_free yade_ground yade_house yade_joint yade_push yade_run yade_scene",
    "tools": "architecture command compare dic environment formats from_pip gates in_memory digests "
             "processor_time",
    "faults": "bad_input damaged_history full_disk odd_files wall_mistakes written",
}
SUBJECT = {f"test_{name}.py": subject for subject, names in SUBJECTS.items() for name in names.split()}
NAMED = 20  # tests that take most

_clock = {"last": 0.0}
_by_test = Counter()


def spent():
    """Processor time [s] of this process and of those that it has waited for."""
    return sum(os.times()[:4])


def pytest_collection_finish():
    _clock["last"] = spent()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_makereport(item):
    """After setup, call and teardown of a test, in the process that runs it; its reports carry it to the summary."""
    now = spent()
    item.user_properties.append(("processor_s", now - _clock["last"]))
    _clock["last"] = now


def pytest_runtest_logreport(report):
    if report.when == "teardown":
        _by_test[report.nodeid] = sum(value for name, value in report.user_properties if name == "processor_s")


def pytest_terminal_summary(terminalreporter):
    by_file, by_subject = Counter(), Counter()
    for test, seconds in _by_test.items():
        file = test.partition("::")[0].rpartition("/")[2]
        by_file[file] += seconds
        by_subject[SUBJECT[file]] += seconds
    for title, table, shown in (("test", _by_test, NAMED), ("file", by_file, None), ("subject", by_subject, None)):
        terminalreporter.section(f"processor time by {title} [s]")
        for name, seconds in table.most_common(shown):
            terminalreporter.write_line(f"{seconds:7.1f}  {name}")
    terminalreporter.write_line(f"{by_subject.total():7.1f}  all; start and collection of the tests left out")
