"""Ground-motion models, a file each; `damage.applications.groningen.exposure.ground_motion` finds
them by the file's name."""
