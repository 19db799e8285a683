"""Rigid top masses (caps) of a wall and the stress in the piers below, as text and as tables."""

from damage.units import GRAVITY


def caps(x, length, mass, thickness):
    """[{"left_m", "right_m", "mass_kg", "stress_pa"}] of caps by their centres [m], lengths [m] and masses [kg].

    thickness [m]: of the wall; stress: that of their weight on what lies under them.

    >>> caps([0.5], [1.0], [1000.0], 0.1)
    [{'left_m': 0.0, 'right_m': 1.0, 'mass_kg': 1000.0, 'stress_pa': 98100.0}]
    """
    return [{"left_m": float(place - long / 2), "right_m": float(place + long / 2), "mass_kg": float(heavy),
             "stress_pa": float(heavy * GRAVITY / (long * thickness))} for place, long, heavy in zip(x, length, mass)]


def describe_cap(cap):
    """A cap in one line.

    >>> describe_cap({"left_m": 0.0, "right_m": 1.0125, "mass_kg": 6350.0, "stress_pa": 6e5})
    'rigid top mass from x = 0 to 1.0125 m: 6.35 t, 0.6 MPa below it'
    """
    left, right = cap["left_m"], cap["right_m"]
    return (f"rigid top mass from x = {left:.5g} to {right:.5g} m: {cap['mass_kg'] / 1e3:.3g} t, "
            f"{cap['stress_pa'] / 1e6:.3g} MPa below it")


def describe_top(layout):
    """Lines on a damage.wall.layout.Layout: the stress in its piers by the load on top, and each cap."""
    of, bodies, wall = layout.options, layout.bodies, layout.wall
    if layout.top_mass == 0:
        return ["no mass on top: no precompression"]
    on_top = slice(layout.n_below_caps, None)
    over = "the length of the wall" if of.load == "length" else "the piers alone"
    places = ", ".join(f"{left:.5g} to {right:.5g} m" for left, right in layout.piers)
    return [f"top: {layout.top_mass / 1e3:.3g} t ({wall.precompression / 1e6:g} MPa over {over}), "
            f"{layout.pier_stress / 1e6:.3g} MPa in the piers below, x = {places}",
            *map(describe_cap, caps(bodies.x[on_top], bodies.length[on_top], bodies.mass[on_top],
                                    wall.brick.thickness))]
