"""Which backend of pyusb carries the transfers: libusb, or one that RIG.toml names."""

import importlib
from typing import Any

import usb.backend

from litrig.base.errors import ConfigError

Backend = Any
"""A `usb.backend.IBackend`; pyusb ships no types."""


def load_backend(name: str | None, address: str) -> Backend | None:
    """Return the backend that MODULE:FUNCTION gives, None for pyusb's own choice.

    Raises
    ------
    ConfigError
        There is no such function, or what it gives is no backend.
    """
    if name is None:
        return None
    module, _, function = name.partition(":")
    try:
        make = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError) as error:
        raise ConfigError(
            f"[lights] usb_backend {name!r} cannot be loaded ({error}); install it, or mend its name"
        ) from (error)
    backend = make(address) if callable(make) else make
    if not isinstance(backend, usb.backend.IBackend):
        raise ConfigError(f"[lights] usb_backend {name!r} gives no backend of pyusb; mend its name")
    return backend
