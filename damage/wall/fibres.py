"""A softening bond as parallel brittle ones: fibres, each a share of a contact point's area that
breaks for itself.

With the brittle law in each fibre, in any solver, their sum softens: unloading goes to the origin,
for those that hold are springs; friction adds up from those that slide.  It needs no softening law
and is the check of it.

Fibre i of m, from 0 on, holds share a_i and breaks at the opening w_i and at the slip s_i of a
contact without normal stress.  The first breaks at f_t / k_n and c / k_s, so that the peaks are
those of the whole bond; just before each break the bond is on the exponential envelope of
`joint_law`, (S1) and (S2), of fracture energies G' that are chosen such that

    1/2 k_n sum a_i w_i^2 = G_I,    1/2 k_s sum a_i s_i^2 = G_II

and tend to G_I, G_II as m grows.  Shares are such that the envelope's stress has fallen by the
share (i/m)^1.5 of the strength where fibre i breaks: equal falls would leave a tenth of the area
after the first break, and the bond too weak at small openings.
"""

from dataclasses import dataclass

import numpy as np

from damage.elementary import exp, log
from damage.errors import InputError
from damage.rounded import to_bits


@dataclass(frozen=True)
class Fibres:
    """Arrays (n_fibres,), contact after contact and weakest first: contact: row of it; share of its
    area [-]; tensile_strength, cohesion of the fibre [Pa]; last: whether it is the last of its
    contact to break."""

    contact: np.ndarray
    share: np.ndarray
    tensile_strength: np.ndarray
    cohesion: np.ndarray
    last: np.ndarray

    def mean(self, values):
        """Of values (..., n_fibres), by shares in each contact: (..., n_contacts)."""
        first = np.flatnonzero(np.append(True, self.last[:-1]))
        return np.add.reduceat(self.share * values, first, axis=-1)


def split_into_fibres(joint, contacts, number):
    """The Fibres of `Contacts` of a Joint that softens (damage.wall.contact_points); a contact that
    is elastic stays one, and so do bricks' cuts and contacts without bond.

    number: of fibres in each contact of mortar.  Raises InputError for brittle joints, for fracture
    energies so low that the envelope snaps back, which no fibre can follow, and for too few fibres
    to hold them.
    """
    if not joint.softens:
        raise InputError(
            f"--fibres {number}: the joints are brittle; give Joint(mode_i_fracture_energy=..., "
            "mode_ii_fracture_energy=...), or leave it out"
        )
    soft = contacts.mortar & (contacts.tensile_strength > 0)
    strengths = contacts.tensile_strength[soft], contacts.cohesion[soft]
    stiffnesses = contacts.normal_stiffness[soft], contacts.shear_stiffness[soft]
    energies = to_bits(joint.mode_i_fracture_energy), to_bits(joint.mode_ii_fracture_energy)
    ductility = [
        energy * stiffness / strength**2
        for energy, stiffness, strength in zip(energies, stiffnesses, strengths)
    ]
    least = [np.max(strength**2 / stiffness) for strength, stiffness in zip(strengths, stiffnesses)]
    if energies[0] <= least[0] or energies[1] <= least[1]:
        raise InputError(
            f"--fibres {number}: expected fracture energies above strength^2 / stiffness of every"
            f" joint, {least[0]:.3g} and {least[1]:.3g} J/m2 in modes I and II, came"
            f" {energies[0]:g} and {energies[1]:g}; give higher ones, or leave --fibres out"
        )
    held = _held(np.sqrt(ductility[0] * ductility[1]), number)
    share = held - np.append(held[:, 1:], np.zeros((len(held), 1)), axis=1)
    per_contact = np.where(soft, number, 1)
    contact = np.repeat(np.arange(len(soft)), per_contact)
    shares, last = np.ones(len(contact)), np.ones(len(contact), bool)
    fibre_strengths = [values[contact] for values in (contacts.tensile_strength, contacts.cohesion)]
    of_soft = soft[contact]
    shares[of_soft] = share.ravel()
    last[:-1] = contact[1:] != contact[:-1]
    for values, strength, ratio in zip(fibre_strengths, strengths, ductility):
        growth = _growth(ratio, held, share)
        if np.any(np.sum(share * growth**2, axis=1) < 2 * ratio * (1 - 1e-6)):
            raise InputError(
                f"--fibres {number}: expected enough to hold the fracture energies of both modes;"
                " give more, up to 64, or leave --fibres out"
            )
        values[of_soft] = (strength[:, None] * growth).ravel()
    return Fibres(contact, shares, *fibre_strengths, last)


def _held(ductility, number):
    """Share of the area that holds before each break, (n, number), for G k / f^2 (n,)."""
    broken = np.arange(number) / number
    stress = 1 - broken * np.sqrt(broken)
    return stress / (stress - ductility[:, None] * log(stress))


def _growth(ductility, held, share):
    """Strengths of the fibres over the first one's (n, number), for G k / f^2 (n,): by bisection
    for G'."""
    _, first, place = np.unique(
        np.column_stack([ductility, held]), axis=0, return_index=True, return_inverse=True
    )
    ductility, held, share = ductility[first], held[first], share[first]  # most contacts are alike
    # below G' = f^2 / k the envelope snaps back
    low, high = np.zeros(len(ductility)), log(ductility) + 5.0
    for _ in range(60):
        middle = (low + high) / 2
        growth = _on_the_envelope(exp(middle), held)
        too_little = np.sum(share * growth**2, axis=1) < 2 * ductility
        low, high = np.where(too_little, middle, low), np.where(too_little, high, middle)
    return growth[place.ravel()]


def _on_the_envelope(ductility, held):
    """Openings over f / k at which the envelope's secant is `held` of the stiffness: held
    (exp(-kappa) + G k / f^2 kappa) = exp(-kappa), by Lambert's function for kappa."""
    return exp(-lambert((1 - held) / (held * ductility[:, None]))) / held


def lambert(y):
    """Lambert's function of y >= 0, the w of w exp(w) = y: by Newton's method, from within a
    fiftieth
    (R. Iacono, J. P. Boyd (2017), Adv. Comput. Math. 43, 1403-1436)."""
    w = log(1.0 + y)
    w = w * (1.0 - log(1.0 + w) / (2.0 + w))
    for _ in range(4):
        w = (w * w + y * exp(-w)) / (1.0 + w)
    return w
