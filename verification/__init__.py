"""Problems with known solutions, which judge every solver: `python3 -m verification`."""
