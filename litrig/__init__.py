"""Capture-rig controller and acquisition toolkit for Anisotropic MatCaps and polynomial texture maps."""
