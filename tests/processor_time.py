"""Processor time of the tests by folder and file, that of the programs they start included.

    bash tests/run.sh -p tests.processor_time

A plugin of pytest.  What a fixture of a module takes counts for the module; what takes most is
named.
"""

import os
from collections import Counter

import pytest

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
    """After setup, call and teardown of a test, in the process that runs it; its reports carry it
    to the summary."""
    now = spent()
    item.user_properties.append(("processor_s", now - _clock["last"]))
    _clock["last"] = now


def pytest_runtest_logreport(report):
    if report.when == "teardown":
        _by_test[report.nodeid] = sum(
            value for name, value in report.user_properties if name == "processor_s"
        )


def pytest_terminal_summary(terminalreporter):
    by_file = Counter()
    by_folder = Counter()
    for test, seconds in _by_test.items():
        path = test.partition("::")[0]
        by_file[path] += seconds
        by_folder[path.rpartition("/")[0]] += seconds
    for title, table, shown in (
        ("test", _by_test, NAMED),
        ("file", by_file, None),
        ("folder", by_folder, None),
    ):
        terminalreporter.section(f"processor time by {title} [s]")
        for name, seconds in table.most_common(shown):
            terminalreporter.write_line(f"{seconds:7.1f}  {name}")
    terminalreporter.write_line(
        f"{by_folder.total():7.1f}  all; start and collection of the tests left out"
    )
