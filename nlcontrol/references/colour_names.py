"""Names of the colours that the camera sees.

Model: each name stands for a few colours that many people called so, from light to dark and from
dull to bright. A colour bears the name of the nearest of them in the CIE 1976 L*a*b* space, where
distances are about as large as people see them; where two names are about equally near (rust is
red and brown), it bears both.

Colours are sRGB, each part in 0…1, under daylight (D65) [xkcd-2010].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

TIE = 5.0
"""Colours about equally near differ by less in their distance; 2.3 is just seen."""

SHADES: dict[str, tuple[str, ...]] = {
    "red": ("e50000", "840000", "ff474c", "bb3f3f", "ff000d"),
    "orange": ("f97306", "c65102", "fdaa48", "d8863b", "ff5b00"),
    "yellow": ("ffff14", "d5b60a", "fffe7a", "eedc5b", "fffd01"),
    "green": ("15b01a", "033500", "96f97b", "74a662", "39ad48", "01ff07"),
    "blue": ("0343df", "00035b", "95d0fc", "49759c", "2c6fbb", "0165fc", "0804f9", "001146"),
    "purple": ("7e1e9c", "35063e", "bf77f6", "84597e", "9e43a2", "be03fd"),
    "pink": ("ff81c0", "cb416b", "ffd1df", "d5869d", "f36196", "fe01b1"),
    "brown": ("653700", "341c02", "ad8150", "876e4b", "7f5112"),
    "black": ("000000",),
    "white": ("ffffff",),
    "grey": ("929591", "363737", "d8dcd6", "7d7f7c"),
}
"""Of each name: the plain colour, then its dark, light, dull, medium and bright as far as named,
and for blue, on which the space is weakest, the primary colour and navy."""

_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""Linear sRGB to CIE XYZ (IEC 61966-2-1)."""

_WHITE = _TO_XYZ.sum(axis=1)


def colour_names(colour: ArrayLike) -> tuple[str, ...]:
    """Basic names of a colour, the nearest first; more than one if they are about as near.

    Args:
        colour: red, green, blue in 0…1, shape (3,).
    """
    there = _lab(np.asarray(colour, dtype=float))
    distance = {
        name: float(np.linalg.norm(shades - there, axis=1).min()) for name, shades in _SEEN.items()
    }
    nearest = min(distance.values())
    near = [name for name in distance if distance[name] < nearest + TIE]
    return tuple(sorted(near, key=distance.__getitem__))


def _lab(rgb: Array) -> Array:
    """Coordinates L*, a*, b* of colours, shape (…, 3)."""
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    t = linear @ _TO_XYZ.T / _WHITE
    x, y, z = np.moveaxis(np.where(t > 216 / 24389, np.cbrt(t), (24389 / 27 * t + 16) / 116), -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


_SEEN = {
    name: _lab(np.array([list(bytes.fromhex(shade)) for shade in shades]) / 255.0)
    for name, shades in SHADES.items()
}
