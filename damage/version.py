"""The version of the software, and nothing that takes time to import."""

VERSION = "0.2.0.dev0"
