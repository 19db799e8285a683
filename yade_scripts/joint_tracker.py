"""State of joints that YADE's law does not store, computed at samples: inelastic opening, slip,
offset, shear limit, friction work and fracture energy.

Offset is the shear displacement of a failed joint less its elastic part, open or closed.  Slip is
the part of it that accumulates while the contact is closed; it is constant while the contact is
open, and over a sample in which it opens or closes.  A joint ends where its faces cease to overlap;
it then keeps its state.

Shear in a house is complex: that of the wall's plane, and i times that across it.
"""

from dataclasses import fields

import numpy as np

from damage.errors import InputError
from damage.law.joint_law import friction_left, material_of
from damage.law.states import AT_LIMIT, BROKEN, CRUSHED, ENDED

FOLLOWED = {
    "friction",
    "normal_stiffness",
    "shear_stiffness",
    "friction_angle",
    "tensile_strength",
    "cohesion",
    "mode_i_fracture_energy",
    "mode_ii_fracture_energy",
    "compressive_strength",
    "compressive_fracture_energy",
}
"""Fields of Joint and of the law's Material that walls in YADE follow."""
_SLIDES = 1e-7  # [m], plastic slip between two samples from which the joint counts as sliding


def check_law(joint):
    """Raise InputError of a damage.wall.parameters.Joint with a number that YADE's joints do not
    follow: they would have the law without it."""
    material = material_of(joint)
    defaults = type(material)._field_defaults
    given = [
        (attribute.name, getattr(joint, attribute.name), attribute.default)
        for attribute in fields(joint)
    ]
    given += [(name, getattr(material, name), defaults.get(name)) for name in material._fields]
    for name, value, default in given:
        if name not in FOLLOWED and value != default:
            raise InputError(
                f"joint law with {name} = {value!r}: expected {default!r}, as YADE's joints do not"
                " follow it; use the reference solver, python3 -m damage reference, or let"
                " yade_scripts follow it and name it in FOLLOWED of yade_scripts/joint_tracker.py"
                " (CONTRIBUTING.md)"
            )


def frictions(layout, broken):
    """Coefficients of friction of all contact points (n_contacts,) [-], intact or broken; between
    two walls of a house the lesser."""
    values = [friction_left(broken, material_of(wall.joint)) for wall in layout.walls]
    return layout.of_contacts(np.array(values))


def signed(shear):
    """Shear as a number: of a complex one its size, with the sign of its part in the plane."""
    return np.copysign(np.abs(shear), np.real(shear)) if np.iscomplexobj(shear) else shear


class JointTracker:
    """State of all joints, arrays (n_joints,): friction of a failed one [-]; opening, slip, offset
    [m]; broken (failed), at_limit, crushed, ended.

    friction_energy, fracture_energy: dissipated so far [J]; breaking_energy: part of the former in
    bonds that soften [J].
    """

    def __init__(self, layout, threshold):
        n = layout.n_joints
        contacts = layout.contacts
        self.friction = frictions(layout, True)[:n]
        self.area = contacts.area[:n]
        self.normal_stiffness = contacts.normal_stiffness[:n]
        self.shear_stiffness = contacts.shear_stiffness[:n]
        self.threshold = threshold
        shear = layout.SHEAR
        self.opening = np.zeros(n)
        (self.slip, self.offset) = np.zeros((2, n), shear)
        self.broken, self.at_limit, self.crushed, self.ended = np.zeros((4, n), bool)
        self.friction_energy = self.breaking_energy = self.fracture_energy = 0.0
        self._slide = layout.slide_limits[:, :n]
        self._open = np.zeros(n, bool)
        (self._stress, self._plastic) = np.zeros((2, n), shear)
        self._passed = {"opened": np.zeros(n, bool), "slipped": np.zeros(n, bool)}

    def breaks(self, joint, kind, sigma, tau):
        """Record the failure of a bond in "tension" or "shear" at stresses sigma, tau [Pa], tension
        positive."""
        kn = self.normal_stiffness[joint]
        ks = self.shear_stiffness[joint]
        area = self.area[joint]
        self.broken[joint] = True
        self._open[joint] = kind == "tension" or sigma > 0
        if self._open[joint]:
            self.fracture_energy += 0.5 * (sigma**2 / kn + abs(tau) ** 2 / ks) * area
        else:
            residual = -sigma * self.friction[joint]
            self.fracture_energy += 0.5 * (abs(tau) - residual) ** 2 / ks * area
            self._stress[joint] = residual
        self.at_limit[joint] |= kind == "shear"

    def softens(self, joint, fracture, friction, opening, slip, slid):
        """Record the energies [J] of a bond that softens in a step, and where it is [m]."""
        self.fracture_energy += fracture
        self._take(friction)
        self.opening[joint] = opening
        self.slip[joint] = slip
        self.offset[joint] = slid
        self._plastic[joint] = slid

    def _take(self, energy):
        self.friction_energy += energy
        self.breaking_energy += energy

    def crushes(self, joint, work):
        """Record that a joint was crushed, and the work of that [J/m2]."""
        self.crushed[joint] = True
        self.fracture_energy += float(self.area[joint]) * work

    def contact_data(self):
        """{column of the history's FRAMES: (n_joints,)} at this time."""
        return {
            "opening_m": self.opening,
            "slip_m": signed(self.slip),
            "offset_m": signed(self.offset),
            "state": (
                BROKEN * self.broken
                + AT_LIMIT * self.at_limit
                + CRUSHED * self.crushed
                + ENDED * self.ended
            ),
        }

    @property
    def followed(self):
        """Indices of the joints to sample: failed, and not ended."""
        return np.flatnonzero(self.broken & ~self.ended)

    def sample(self, joints, opening, shear, tau, gap=None):
        """Update failed joints from a sample.

        joints: indices (m,); opening, shear: displacements, (m,) [m]; tau: shear stress, (m,) [Pa];
        gap: opening to record where it differs from that of the contact, (m,) [m], or None.
        Returns [(joint, "opened" | "slipped"),
        ...] where opening or slip exceeds the threshold for the first time.
        """
        is_open = opening > 0
        area = self.area[joints]
        plastic = shear - tau / self.shear_stiffness[joints]
        stays_closed = ~is_open & ~self._open[joints]
        increment = np.where(stays_closed, plastic - self._plastic[joints], 0.0)
        mean_stress = (np.abs(tau) + np.abs(self._stress[joints])) / 2
        self.friction_energy += float(np.sum(mean_stress * np.abs(increment) * area))
        # The elastic shear energy of a joint dissipates by friction as it opens, since its limit
        # falls to zero.
        opens = is_open & ~self._open[joints]
        stored = np.where(
            opens, np.abs(self._stress[joints]) ** 2 / (2 * self.shear_stiffness[joints]), 0.0
        )
        self.friction_energy += float(np.sum(stored * area))
        limit = -opening * self.normal_stiffness[joints] * self.friction[joints]
        slides = ~is_open & (np.abs(tau) >= limit * (1 - 1e-6)) & (tau != 0)
        self.at_limit[joints] |= (slides | (np.abs(increment) > _SLIDES)) & self.broken[joints]
        self.slip[joints] += increment
        seen = opening if gap is None else np.maximum(gap, 0.0)
        self.opening[joints] = np.where(is_open, seen, 0.0)
        self.offset[joints] = plastic
        self._open[joints] = is_open
        self._plastic[joints] = plastic
        self._stress[joints] = np.where(is_open, 0.0, tau)
        least, most = self._slide[:, joints]
        self.ended[joints] = self.broken[joints] & (
            (np.real(shear) <= least) | (np.real(shear) >= most)
        )
        return self._first_passings()

    def _first_passings(self):
        values = {"opened": self.opening, "slipped": np.abs(self.slip)}
        news = []
        for kind, value in values.items():
            new = (value > self.threshold) & ~self._passed[kind]
            self._passed[kind] |= new
            news += [(int(joint), kind) for joint in np.flatnonzero(new)]
        return news
