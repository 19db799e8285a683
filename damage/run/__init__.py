"""One run, whichever solver does it: its options, stages, history, summary and pictures."""
