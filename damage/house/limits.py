"""What houses cannot do yet; each is refused with its reason."""

from damage.errors import InputError

OF_WALLS = {
    "fracture energies of joints": lambda wall: wall.joint.softens,
    "a compressive strength of joints": lambda wall: wall.joint.compressive_strength,
    "bricks that split": lambda wall: wall.brick.splits,
    "restraints": lambda wall: wall.restraints,
}
OF_MODELS = {
    "--bricks deformable": lambda options: options.bricks != "rigid",
    "--soil": lambda options: options.soil != "rigid",
}
OF_SOLVERS = {
    "the reference solver, whose bodies move in a plane": lambda solver: solver == "reference"
}
OF_RUNS = {
    "displacements of supports": lambda settings: settings.loading.drive.supports,
    "a pushed top that may not rotate freely": lambda settings: (
        settings.loading.drive.top
        and (not settings.loading.drive.top_rotates or settings.loading.drive.top_stiffness)
    ),
    "joints without bond": lambda settings: settings.joints_without_bond,
    "--after-fall": lambda settings: settings.after_fall,
    "--mass-scaling": lambda settings: settings.scales,
}


def refuse(place, limits, given, expected):
    """Raise InputError where what is given has one of these limits; place: of the message;
    expected: instead, and how to correct it."""
    for what, asks in limits.items():
        if asks(given):
            raise InputError(f"{place} with {what}: expected {expected}")
