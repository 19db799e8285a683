"""The time that is left of work: right where the pace is steady, and not known where it is not."""

import io
from types import SimpleNamespace

import pytest

from damage.run import pace
from damage.run.pace import Pace
from damage.run.progress import Progress


@pytest.fixture
def clock(monkeypatch):
    """A list of the time [s], which a test sets."""
    now = [1000.0]
    monkeypatch.setattr(pace.time, "monotonic", lambda: now[0])
    return now


def followed(clock, rates, whole):
    """[time left as said] after each second of work at these rates, of so much in all."""
    work = Pace()
    done = 0.0
    said = []
    for rate in rates:
        clock[0] += 1.0
        done += rate
        work.note(done)
        said.append(work.left_s(whole - done))
    return said


def test_work_at_one_pace_takes_as_long_as_is_said(clock):
    """300 units at 2 a second, after compilation in which none is done."""
    said = followed(clock, [0.0] * 60 + [2.0] * 100, 300.0)
    assert said[:75] == [None] * 75
    assert said[79] == pytest.approx(130.0) and said[-1] == pytest.approx(50.0)


def test_a_pace_that_changes_is_not_known_until_it_is_steady(clock):
    """Work that becomes four times as slow: what is said is within a factor of two of what follows,
    but for the moments in which nobody can know it."""
    rates = [4.0] * 25 + [1.0] * 100
    said = followed(clock, rates, 200.0)
    assert said[20] == pytest.approx((200 - 4 * 21) / 4)
    assert None in said[25:35] and said[90] == pytest.approx(200 - 100 - 66)
    known = [(left, 125 - k - 1) for k, left in enumerate(said) if left and k > 35]
    assert known and all(0.5 < left / follows < 2 for left, follows in known)


@pytest.mark.parametrize(("most", "left_s"), [(20.0, 14.142), (21.0, None)])
def test_work_of_unknown_size_has_a_time_where_both_ends_are_within_a_factor_of_two(
    clock, most, left_s
):
    work = Pace()
    for done in range(1, 21):
        clock[0] += 1.0
        work.note(float(done))
    assert work.left_s(10.0, most) == (left_s and pytest.approx(left_s, rel=1e-4))


def test_a_run_says_its_time_left_on_the_screen(clock):
    stream = io.StringIO()
    progress = Progress("wall", stream)
    for k in range(1, 41):
        clock[0] += 1.0
        run = SimpleNamespace(stage="motion", duration_s=10.0, index=0.0, share=k / 100)
        progress.show(k / 10, run)
    lines = stream.getvalue().splitlines()
    assert lines[-1].endswith("DI = 0.000, time left about 1:00")
