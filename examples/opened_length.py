"""The length of joints that are open by more than 0.1 mm, over time: a history read with pandas,
and plotted.

    python3 -m examples.opened_length FILE.h5 PICTURE.png
"""

import sys

import matplotlib

matplotlib.use("Agg")  # no screen is needed

import matplotlib.pyplot as plt
import pandas as pd

import damage


def opened_length(history, threshold_m=1e-4):
    """DataFrame over time [s]: opened length of bed and head joints [m]; a row of `joints` is a
    contact point."""
    is_open = (history.opening_m > threshold_m).astype(float)
    wide = pd.DataFrame(is_open, index=history.series["time_s"])  # a column a contact point
    joints = history.joints.query("kind != 'brick'")  # these lie within bricks and lintels
    return pd.DataFrame(
        {
            f"{kind}_m": wide.loc[:, members.index] @ members["length_m"]
            for kind, members in joints.groupby(joints["kind"].astype(str))
        }
    )


def main(path, picture):
    """Print the largest length and the last, write the picture."""
    history = damage.read_history(path)
    length = opened_length(history)
    print(pd.DataFrame({"largest": length.max(), "at the end": length.iloc[-1]}).round(3))
    axes = length.plot(ylabel="opened length [m]", xlabel="time [s]", title=history.wall)
    axes.figure.savefig(picture)
    plt.close(axes.figure)


if __name__ == "__main__":
    main(*sys.argv[1:])
