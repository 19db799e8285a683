"""Run of a wall as data (TOML) in YADE: `./yade WALL.toml [OPTIONS]` starts this with the file's
path first."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))  # YADE does not look here by itself

if __name__ == "__main__":
    from damage.wall.file import read_wall
    from yade_scripts.run import main

    del sys.argv[0]  # the wall's file stands for the script from here on
    main(lambda: read_wall(sys.argv[0]))
