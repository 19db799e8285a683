"""Construction of the tables of a wall at rest from its layout."""

import numpy as np

from damage.law.joint_law import (
    ContactState,
    LawParameters,
    Material,
    elastic_range,
    material_of,
    range_left,
)
from damage.mechanics.interfaces import Springs
from damage.mechanics.tables import (
    CONTACT,
    HAS_FAILED,
    INDEX,
    INTERFACE,
    LARGEST_OPENING,
    LARGEST_SLIDE,
    RIGID,
    ROTATION,
    Cuts,
    Strain,
    make_tables,
    system_of,
    table,
)
from damage.rounded import to_bits
from damage.units import GRAVITY
from damage.wall.kinds import CAP_COURSE, CUT, rows
from damage.wall.kinematics import slide_limits
from damage.wall.restraints import top_of
from damage.wall.split import beside_cuts

CAPACITY = 100_000
"""Largest number of events between two calls that empty the log."""


def build(layout):
    """The Tables of a damage.wall.layout.Layout.

    Its contacts are the contact points of the layout.  Its bodies are those of the layout, then the
    supports.
    """
    interfaces, middle = _interfaces(layout)
    points = layout.contacts
    # Offsets follow the joint's axes: along +x in bed joints, along -z in head joints.
    offset = np.where(points.upright, middle[1] - points.z, points.x - middle[0])
    contacts = table(CONTACT, len(points), area=points.area, offset=offset)
    n_bodies = len(layout.bodies)
    n_modes = layout.strain.n_modes if layout.strain else 0
    tables = make_tables(
        n_bodies + len(layout.supports),
        RIGID + n_modes,
        interfaces,
        contacts,
        n_bearings=n_bodies if top_of(layout.wall) else 0,
        capacity=CAPACITY,
    )
    system = system_of(tables, 0)
    system.material[:] = material_of(layout.wall.joint)
    _set_strengths(system.strengths, layout)
    for name, values in range_left(ContactState(), law_of(system))._asdict().items():
        system.states[f"elastic_{name}"] = values
    system.states["idle"] = -1.0
    sum_springs(system, layout.strain)
    system.mass[:n_bodies, :RIGID] = layout.bodies.mass[:, None]
    system.mass[:n_bodies, ROTATION] = layout.bodies.inertia
    if layout.strain:
        system.mass[:n_bodies, RIGID:] = layout.strain.mass
    system.inverse_mass[system.mass > 0] = 1 / system.mass[system.mass > 0]
    system.inverse_mass[:n_bodies, :RIGID][layout.restrained] = 0.0
    if top := top_of(layout.wall):
        beam = layout.bodies.course == CAP_COURSE
        system.bearings["load"] = layout.load_mass
        if top.stiffness:
            system.bearings["stiffness"][beam] = top.stiffness
            system.bearings["play"][beam] = top.play
            system.bearings["limit"][beam] = top.friction * GRAVITY * layout.top_mass
    return tables


def strain_tables(layout):
    """The Strain of a damage.wall.layout.Layout, None of rigid bricks."""
    strain = layout.strain
    if strain is None:
        return None
    resting = np.zeros((len(layout.supports), strain.n_modes))
    return Strain(
        np.vstack([strain.stiffness, resting]),
        np.vstack([strain.damping, resting]),
        strain.shapes,
        np.column_stack([strain.first, strain.second]).astype(INDEX),
    )


def cut_tables(layout, interfaces):
    """The Cuts of a damage.wall.layout.Layout; interfaces: table INTERFACE."""
    cuts, beside = beside_cuts(layout.contacts)
    contact = [np.unique(of_cut[of_cut >= 0]) for of_cut in beside]
    every = np.concatenate([np.zeros(0, int), *contact])
    return Cuts(
        np.searchsorted(interfaces["start"], cuts),
        np.cumsum([0, *map(len, contact)]),
        every,
        np.array([layout.wall.brick.tensile_strength or 0.0]),
    )


def _set_strengths(strengths, layout):
    """Fill the table STRENGTHS."""
    contacts = layout.contacts
    joint = layout.wall.joint
    of_cuts = to_bits(layout.wall.brick.fracture_energy or 0.0)
    of_joints = np.where(contacts.tensile_strength == 0, 0.0, 1.0)
    mode_i, mode_ii = (
        np.where(contacts.kind == CUT, of_cuts, of_joints * to_bits(energy or 0.0))
        for energy in (joint.mode_i_fracture_energy, joint.mode_ii_fracture_energy)
    )
    strengths["normal_stiffness"] = contacts.normal_stiffness
    strengths["shear_stiffness"] = contacts.shear_stiffness
    for name, values in (
        ("tensile_strength", contacts.tensile_strength),
        ("cohesion", contacts.cohesion),
        ("mode_i_energy", mode_i),
        ("mode_ii_energy", mode_ii),
        ("compressive_strength", contacts.compressive_strength),
        ("crushing_energy", to_bits(joint.compressive_fracture_energy or 0.0)),
    ):
        strengths[name] = values * contacts.area


def _interfaces(layout):
    """Table INTERFACE, and for each contact the middle (x, z) of its interface [m].

    The contact points of an interface are neighbours in the layout.
    """
    contacts = layout.contacts
    bodies = layout.bodies
    first = rows(contacts.first, len(bodies))
    second = contacts.second
    changes = np.any([np.diff(first) != 0, np.diff(second) != 0], axis=0)
    start = np.append(0, np.flatnonzero(changes) + 1)
    stop = np.append(start[1:], len(contacts))
    middle = [
        (np.minimum.reduceat(place, start) + np.maximum.reduceat(place, start)) / 2
        for place in (contacts.x, contacts.z)
    ]
    x = np.append(bodies.x, layout.supports.x)
    z = np.append(bodies.z, np.zeros(len(layout.supports)))
    a = first[start]
    b = second[start]
    upright = contacts.upright[start]
    least, most = slide_limits(contacts.first[start], b, upright, bodies)
    interfaces = table(
        INTERFACE,
        len(start),
        ax=middle[0] - x[a],
        az=middle[1] - z[a],
        bx=middle[0] - x[b],
        bz=middle[1] - z[b],
        a=a,
        b=b,
        start=start,
        stop=stop,
        slide_least=least,
        slide_most=most,
        head=upright,
    )
    return interfaces, [np.repeat(values, stop - start) for values in middle]


def law_of(system):
    """LawParameters of all contact points, without fracture energies."""
    strengths = system.strengths
    area = system.contacts["area"]
    return LawParameters(
        strengths["normal_stiffness"] * area,
        strengths["shear_stiffness"] * area,
        strengths["tensile_strength"],
        strengths["cohesion"],
        Material(*system.material),
        compressive_strength=strengths["compressive_strength"],
    )


def sum_springs(system, strain=None):
    """Write the resultant springs of intact interfaces into the tables, and the limits up to which
    these hold.

    strain: of the layout, None where bricks are rigid; between deformable bricks contact points are
    evaluated one by one.
    """
    start = system.interfaces["start"]
    offset = system.contacts["offset"]
    limits = system.limits
    law = law_of(system)
    kn = law.normal_stiffness
    ks = law.shear_stiffness
    with np.errstate(divide="ignore", invalid="ignore"):
        opening, slide, ratio = elastic_range(law)
        limits[:, LARGEST_OPENING] = np.minimum.reduceat(opening, start)
        limits[:, LARGEST_SLIDE] = np.minimum.reduceat(slide, start)
    sums = (
        np.add.reduceat(stiffness, start) for stiffness in (kn, ks, kn * offset, kn * offset**2)
    )
    reach = np.maximum.reduceat(np.abs(offset), start)
    system.springs[:] = np.column_stack(Springs(*sums, reach, ratio[start]))
    # The limit at the outermost contact point bounds all others only where they have the same ratio
    # of stiffness and friction; elsewhere a limit of -inf has every contact point evaluated by
    # itself.
    alike = np.isclose(
        np.repeat(ratio[start], np.diff(start, append=len(kn))), ratio, rtol=1e-12, atol=0
    )
    # Contacts that can crush, those of deformable bricks, and failed ones are evaluated by
    # themselves, too.
    alike &= (law.compressive_strength == np.inf) & (strain is None)
    limits[
        ~np.logical_and.reduceat(alike, start) | (limits[:, HAS_FAILED] > 0), LARGEST_OPENING
    ] = -np.inf
