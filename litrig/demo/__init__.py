"""The whole path on a simulated rig."""
