"""What YADE's law does not keep of a joint, from samples of it: inelastic opening and slip, the
shear limit, friction work and fracture energy.

Offset is the shear displacement of a broken joint less its elastic part, open or closed.  Slip is what of it came
about while the contact was closed: frozen while it is open, and over a sample in which it opens or closes.  A joint
whose faces no longer overlap has ended, and keeps what it had then.
"""

import numpy as np

from damage.history.schema import AT_LIMIT, BROKEN, CRUSHED, ENDED
from damage.wall.joint_law import friction_left, material_of
from damage.wall.kinematics import slide_limits

_SLIDES = 1e-7  # [m] of plastic slip between two samples shows that the joint slid


class JointTracker:
    """State of all joints; arrays of shape (n_joints,): opening, slip, offset [m], broken, at_limit, crushed,
    ended; dry: share of the area whose bond is gone [-].  Of joints that are fibres opening, slip and offset are the
    means over all, by shares, and broken and at the limit are those whose last one is.

    friction_energy, fracture_energy [J]; of the first what fibres take as they break: breaking_energy.
    """

    def __init__(self, layout, threshold):
        n, contacts = layout.n_joints, layout.contacts
        self.friction = friction_left(True, material_of(layout.wall.joint))
        self.area = contacts.area[:n]
        self.normal_stiffness = contacts.normal_stiffness[:n]
        self.shear_stiffness = contacts.shear_stiffness[:n]
        self.threshold = threshold
        self.opening, self.slip, self.offset = np.zeros(n), np.zeros(n), np.zeros(n)
        self.broken, self.at_limit, self.crushed, self.ended = np.zeros((4, n), bool)
        self.dry, self._crushing = np.zeros(n), contacts.compressive_strength[:n] * self.area
        self.friction_energy = self.breaking_energy = self.fracture_energy = 0.0
        self._slide = np.array(slide_limits(contacts.first, contacts.second, contacts.upright, layout.bodies))[:, :n]
        self._open, self._stress, self._plastic = np.zeros(n, bool), np.zeros(n), np.zeros(n)
        self._passed = {"opened": np.zeros(n, bool), "slipped": np.zeros(n, bool)}

    def breaks(self, joint, kind, sigma, tau, share=1.0, last=True):
        """A bond breaks in "tension" or "shear" under stresses sigma, tau [Pa] (tension positive), all of it or the
        `last` share that holds."""
        kn, ks, area = self.normal_stiffness[joint], self.shear_stiffness[joint], self.area[joint] * share
        self.broken[joint] |= last
        self.dry[joint] += share
        self._open[joint] = kind == "tension" or sigma > 0
        if self._open[joint]:
            self.fracture_energy += 0.5 * (sigma**2 / kn + tau**2 / ks) * area
        else:
            residual = -sigma * self.friction
            self.fracture_energy += 0.5 * (abs(tau) - residual) ** 2 / ks * area
            self._stress[joint] = residual
        self.at_limit[joint] |= kind == "shear" and last

    def fibre_breaks(self, joint, kind, sigma, tau, share, last):
        """`breaks` of a share of a joint whose dry part, if it has one, was sampled at this instant.

        The fibre slides at once down to its limit, and shares its stress with those that are dry.
        """
        ks, area, dry, stress = self.shear_stiffness[joint], self.area[joint], self.dry[joint], self._stress[joint]
        self.breaks(joint, kind, sigma, tau, share, last)
        rubs = 0.0 if self._open[joint] else min(abs(tau), self._stress[joint])
        if not self._open[joint]:
            slid = (abs(tau) - rubs) / ks
            self.slip[joint] += share * np.copysign(slid, tau)
            self._take(rubs * slid * share * area)
        rubs = np.copysign(rubs, tau)
        mean = (dry * stress + share * rubs) / (dry + share)
        lost = dry * stress**2 + share * rubs**2 - (dry + share) * mean**2
        self._take(lost / (2 * ks) * area)
        self._stress[joint], self._plastic[joint] = mean, (tau - mean) / ks
        self.offset[joint] = self.dry[joint] * self._plastic[joint]

    def _take(self, energy):
        self.friction_energy += energy
        self.breaking_energy += energy

    def crushes(self, joint, more):
        """A joint is crushed by so much more [m]."""
        self.crushed[joint] = True
        self.fracture_energy += float(self._crushing[joint]) * more

    def contact_data(self):
        """{column of the history's FRAMES: (n_joints,)} of this instant."""
        return {"opening_m": self.opening, "slip_m": self.slip, "offset_m": self.offset,
                "state": BROKEN * self.broken + AT_LIMIT * self.at_limit + CRUSHED * self.crushed + ENDED * self.ended}

    @property
    def followed(self):
        """Indices of the joints to sample: those whose bond has gone, at least in part, and that have not ended."""
        return np.flatnonzero((self.dry > 0) & ~self.ended)

    def sample(self, joints, opening, shear, tau, gap=None):
        """Take a sample of broken joints.

        joints: indices (m,); opening, shear displacement [m] and shear stress tau [Pa]: (m,); gap: what is seen of the
        opening where that is not all of it (m,).
        Yields (joint, "opened" | "slipped") at the first passing of the threshold.
        """
        is_open, area = opening > 0, self.area[joints] * self.dry[joints]
        plastic = shear - tau / self.shear_stiffness[joints]
        stays_closed = ~is_open & ~self._open[joints]
        increment = np.where(stays_closed, plastic - self._plastic[joints], 0.0)
        mean_stress = (np.abs(tau) + np.abs(self._stress[joints])) / 2
        self.friction_energy += float(np.sum(mean_stress * np.abs(increment) * area))
        # What shear a joint still held when it opens slides off, as its limit falls to nothing.
        opens = is_open & ~self._open[joints]
        held = np.where(opens, self._stress[joints] ** 2 / (2 * self.shear_stiffness[joints]), 0.0)
        self.friction_energy += float(np.sum(held * area))
        limit = -opening * self.normal_stiffness[joints] * self.friction
        slides = ~is_open & (np.abs(tau) >= limit * (1 - 1e-6)) & (tau != 0)
        self.at_limit[joints] |= (slides | (np.abs(increment) > _SLIDES)) & self.broken[joints]
        self.slip[joints] += self.dry[joints] * increment
        seen = opening if gap is None else np.maximum(gap, 0.0)
        self.opening[joints] = np.where(is_open, self.dry[joints] * seen, 0.0)
        self.offset[joints] = self.dry[joints] * plastic
        self._open[joints], self._plastic[joints] = is_open, plastic
        self._stress[joints] = np.where(is_open, 0.0, tau)
        least, most = self._slide[:, joints]
        self.ended[joints] = self.broken[joints] & ((shear <= least) | (shear >= most))
        return self._first_passings()

    def _first_passings(self):
        values = {"opened": self.opening, "slipped": np.abs(self.slip)}
        news = []
        for kind, value in values.items():
            new = (value > self.threshold) & ~self._passed[kind]
            self._passed[kind] |= new
            news += [(int(joint), kind) for joint in np.flatnonzero(new)]
        return news
