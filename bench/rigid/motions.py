"""The twenty motions, from rest to rest [rad]; q = 0 hangs straight down."""
import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True)
class Motion:
    name: str
    start: tuple[float, float]
    goal: tuple[float, float]

    @property
    def ends(self):
        return np.array(self.start), np.array(self.goal)


MOTIONS = [Motion(*row) for row in (
    ("short 1", (0, 0), (0.1, -0.1)),
    ("short 2", (0, 0), (0.2, 0)),
    ("short 3", (0, 0), (0, 0.3)),
    ("short 4", (0.8, -0.5), (0.9, -0.3)),
    ("short 5", (1.2, -0.8), (1.1, -0.6)),
    ("long 1", (-1.2, 0.8), (1.2, -0.8)),
    ("long 2", (-1.4, 1.5), (1.4, -1.5)),
    ("long 3", (-0.8, -2), (0.8, 2)),
    ("long 4", (0, -2.2), (0, 2.2)),
    ("up 1", (0, 0), (1.2, -0.8)),
    ("up 2", (0, 0), (1.4, 0)),
    ("up 3", (0.4, 0.3), (1.6, -1.2)),
    ("up 4", (0, 0), (-1.3, 1.8)),
    ("down 1", (1.2, -0.8), (0, 0)),
    ("down 2", (1.4, 0), (0, 0)),
    ("down 3", (1.6, -1.2), (0.4, 0.3)),
    ("down 4", (-1.3, 1.8), (0, 0)),
    ("against 1", (0.6, -1.6), (-0.6, 1.6)),
    ("against 2", (-0.3, 1.0), (0.6, -1.0)),
    ("against 3", (1.0, 0.4), (0.5, 1.2)),
)]
