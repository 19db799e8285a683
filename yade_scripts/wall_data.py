"""Run of a wall or a house as data (TOML) in YADE: `./yade FILE.toml [OPTIONS]` starts this with
the file's path first."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))  # YADE does not look here by itself

if __name__ == "__main__":
    from damage.house.house import read_wall_or_house
    from yade_scripts.run import main

    del sys.argv[0]  # the wall's file stands for the script from here on
    main(lambda: read_wall_or_house(sys.argv[0]))
