"""The source paper, doi:10.1016/j.engstruct.2021.112529: its claims, the runs that bear on them,
the verdict."""

import damage.applications  # noqa: F401, each adds its options
