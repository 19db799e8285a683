"""Names, codes and units of the history file; `docs/history-schema.md` is the schema."""

SCHEMA = "masonry-damage-history"
SCHEMA_VERSION = 1
STATUS = ("unfinished", "complete", "interrupted", "failed")
STAGES = ("motion", "rest", "settling")
EVENTS = ("tension", "shear", "opened", "slipped")
BROKEN, AT_LIMIT = 1, 2  # bits of frames/state
# Column -> unit of the time series; the energies are since the end of the static stage.
SERIES = {
    "time_s": "s", "base_acceleration_x_m_s2": "m/s2", "base_acceleration_z_m_s2": "m/s2",
    "top_displacement_m": "m", "drift_ratio": "1", "base_shear_n": "N", "top_force_n": "N",
    "kinetic_energy_j": "J", "elastic_energy_j": "J", "gravity_energy_j": "J",
    "input_energy_j": "J", "friction_energy_j": "J", "fracture_energy_j": "J",
    "damping_energy_j": "J",
}
STATIC = {
    "base_reaction_n": "N", "weight_n": "N", "unbalanced_force": "1", "broken_joints": "1",
    "duration_s": "s",
}
