"""Draws a game from above, with numpy alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from squall._native import Scene

Colour = tuple[int, int, int]

_WATER: Colour = (24, 58, 82)
_FIELD: Colour = (38, 84, 112)
_LINE: Colour = (235, 235, 235)
_TEAMS: tuple[Colour, Colour] = ((88, 166, 255), (255, 99, 88))
# Each digit is five rows of three pixels, the highest bit to the left.
_ROWS = {
    "0": (7, 5, 5, 5, 7),
    "1": (2, 6, 2, 2, 7),
    "2": (7, 1, 7, 4, 7),
    "3": (7, 1, 7, 1, 7),
    "4": (5, 5, 7, 1, 1),
    "5": (7, 4, 7, 1, 7),
    "6": (7, 4, 7, 5, 7),
    "7": (7, 1, 1, 1, 1),
    "8": (7, 5, 7, 5, 7),
    "9": (7, 5, 7, 1, 7),
}


def draw(scene: Scene, width_px: int = 640) -> NDArray[np.uint8]:
    """The picture of a scene, (height, width, 3).

    The first team's end is on the left. Boats are triangles that point ahead; tagged ones are pale, and carriers have a ring in the other
    team's colour. Flags are discs at their homes, or rings while they are away. The scores are above, in the teams' colours.
    """
    return _Picture(scene, width_px).pixels


class _Picture:
    def __init__(self, scene: Scene, width_px: int) -> None:
        margin_m = 0.05 * scene["width_m"]
        self._px_per_m = width_px / (scene["width_m"] + 2 * margin_m)
        height_px = round((scene["depth_m"] + 2 * margin_m) * self._px_per_m)
        self._margin_m, self._top_m = margin_m, scene["depth_m"] + margin_m
        self.pixels = np.full((height_px, width_px, 3), _WATER, dtype=np.uint8)
        self._rectangle(0.0, 0.0, scene["width_m"], scene["depth_m"], _FIELD)
        half_px_m = 0.5 / self._px_per_m
        middle_m = scene["width_m"] / 2
        self._rectangle(middle_m - half_px_m, 0.0, middle_m + half_px_m, scene["depth_m"], _LINE)
        size_m = max(scene["width_m"] / 45, 2.0)
        for along_m, across_m, team, carrier in scene["flags"]:
            inner_m = 0.0 if carrier < 0 else 0.35 * size_m
            self._ring(along_m, across_m, inner_m, 0.5 * size_m, _TEAMS[int(team)])
        for along_m, across_m, heading_rad, team, tagged, carrying in scene["boats"]:
            colour = _TEAMS[int(team)]
            if carrying:
                self._ring(along_m, across_m, 0.9 * size_m, 1.15 * size_m, _TEAMS[1 - int(team)])
            self._boat(along_m, across_m, heading_rad, size_m, _pale(colour) if tagged else colour)
        for team, score in enumerate(scene["score"][:2]):
            self._number(score, int(width_px * (0.25 + 0.5 * team)), _TEAMS[team])

    def _pixel(self, along_m: float, across_m: float) -> tuple[float, float]:
        """Column and row."""
        return (along_m + self._margin_m) * self._px_per_m, (self._top_m - across_m) * self._px_per_m

    def _rectangle(self, left_m: float, bottom_m: float, right_m: float, top_m: float, colour: Colour) -> None:
        left, top = self._pixel(left_m, top_m)
        right, bottom = self._pixel(right_m, bottom_m)
        self.pixels[round(top) : round(bottom), round(left) : max(round(right), round(left) + 1)] = colour

    def _around(
        self, along_m: float, across_m: float, radius_m: float
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
        """The pixels of a square around a position, and their offsets from it, m: (2, rows, columns), along and across."""
        column, row = self._pixel(along_m, across_m)
        reach = radius_m * self._px_per_m + 1
        height, width, _ = self.pixels.shape
        top, bottom = (int(np.clip(edge, 0, height)) for edge in (row - reach, row + reach + 1))
        left, right = (int(np.clip(edge, 0, width)) for edge in (column - reach, column + reach + 1))
        rows, columns = np.mgrid[top:bottom, left:right]
        from_m = np.stack([columns + 0.5 - column, row - rows - 0.5]) / self._px_per_m
        return self.pixels[top:bottom, left:right], from_m

    def _ring(self, along_m: float, across_m: float, inner_m: float, outer_m: float, colour: Colour) -> None:
        pixels, from_m = self._around(along_m, across_m, outer_m)
        distance_m = np.hypot(*from_m)
        pixels[(distance_m >= inner_m) & (distance_m <= outer_m)] = colour

    def _boat(self, along_m: float, across_m: float, heading_rad: float, size_m: float, colour: Colour) -> None:
        pixels, (along, across) = self._around(along_m, across_m, size_m)
        ahead = along * np.cos(heading_rad) + across * np.sin(heading_rad)
        aside = across * np.cos(heading_rad) - along * np.sin(heading_rad)
        # From full width at the stern to a point at the bow.
        pixels[(ahead >= -0.6 * size_m) & (np.abs(aside) <= 0.33 * (0.9 * size_m - ahead))] = colour

    def _number(self, number: int, column: int, colour: Colour) -> None:
        scale = max(int(0.6 * self._margin_m * self._px_per_m) // 5, 1)
        for digit in str(number):
            bits = np.array([[row >> 2 & 1, row >> 1 & 1, row & 1] for row in _ROWS[digit]], dtype=bool)
            mask = np.kron(bits, np.ones((scale, scale), dtype=bool))
            place = self.pixels[scale : scale + mask.shape[0], column : column + mask.shape[1]]
            place[mask[: place.shape[0], : place.shape[1]]] = colour
            column += 4 * scale


def _pale(colour: Colour) -> Colour:
    red, green, blue = ((own + 2 * field) // 3 for own, field in zip(colour, _FIELD, strict=True))
    return red, green, blue
