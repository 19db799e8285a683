"""Ground-motion models, a file each; `damage.exposure.ground_motion` finds them by the file's name."""
