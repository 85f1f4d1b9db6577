"""The keys of a scene file, their types, ranges and defaults.

The `description` of a field completes the sentence "KEY must be ..." that a user reads.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

SMALLEST_NODES = 400
LARGEST_NODES = 50_000_000
NAME_PATTERN = re.compile(r"[A-Za-z0-9_-]{1,64}")
NAME_ALLOWED = "letters, digits, - and _, at most 64 of them"

LENGTH = "a length in mm from 1e-6 to 1e9"
POINT = "two finite numbers in mm, [x, y], each from -1e9 to 1e9"


def _tuple_of(value: object) -> object:
    """A TOML array as the tuple that the models hold."""
    return tuple(value) if isinstance(value, list) else value


def _printable(text: object) -> object:
    """Refuse control characters: a title is printed on terminals and in pages."""
    if isinstance(text, str) and not text.isprintable():
        raise ValueError("control characters")
    return text


def _symmetry(text: object) -> object:
    """Refuse a word that is no symmetry reduction."""
    if isinstance(text, str) and not re.fullmatch(
        r"auto|none|half-x|half-y|quarter|axisymmetric|sector:[1-9]\d{0,3}", text
    ):
        raise ValueError("not a symmetry")
    return text


Length = Annotated[float, Field(ge=1e-6, le=1e9, description=LENGTH)]
Distance = Annotated[float, Field(ge=-1e9, le=1e9)]
Vector = Annotated[
    tuple[Distance, Distance, Distance],
    BeforeValidator(_tuple_of),
    Field(description="three finite numbers in mm, [x, y, z], each from -1e9 to 1e9"),
]
Point = Annotated[
    tuple[Distance, Distance],
    BeforeValidator(_tuple_of),
    Field(description=POINT),
]
Title = Annotated[
    str,
    BeforeValidator(_printable),
    Field(max_length=200, description="one line of text, at most 200 characters"),
]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$", description=NAME_ALLOWED)]
Reduction = Annotated[
    str,
    BeforeValidator(_symmetry),
    Field(
        description='"auto", "none", "half-x", "half-y", "quarter", "axisymmetric" or "sector:N", N from 1 to 9999',
        json_schema_extra={
            "choices": ["auto", "none", "half-x", "half-y", "quarter", "axisymmetric", "sector:6"]
        },
    ),
]
Bias = Annotated[float | None, Field(ge=0.0, le=5.0, description="a number from 0 (uniform) to 5")]
Switch = Literal["auto", "on", "off"]


class Table(BaseModel):
    """One table of a scene file: no unknown keys, no conversions but whole numbers to numbers, no NaN."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", allow_inf_nan=False)


class Sheet(Table):
    """What every shape has."""

    edge_names: ClassVar[tuple[str, ...]] = ()
    thickness_mm: Length = 0.025


class RectangleSheet(Sheet):
    """A rectangle, width along x, height along y, centred at the origin."""

    edge_names: ClassVar[tuple[str, ...]] = ("left", "right", "bottom", "top")
    shape: Literal["rectangle"] = "rectangle"
    width_mm: Length = 101.6
    height_mm: Length = 254.0

    @property
    def smallest_width_mm(self) -> float:
        """The narrowest part of the sheet, mm."""
        return min(self.width_mm, self.height_mm)

    @property
    def size_mm(self) -> float:
        """The largest in-plane extent, mm."""
        return max(self.width_mm, self.height_mm)


class HoleSheet(Sheet):
    """A rectangle with a central circular hole."""

    edge_names: ClassVar[tuple[str, ...]] = ("left", "right", "bottom", "top", "hole")
    shape: Literal["rectangle-with-hole"] = "rectangle-with-hole"
    width_mm: Length = 50.0
    height_mm: Length = 125.0
    hole_radius_mm: Length = 15.0

    @property
    def smallest_width_mm(self) -> float:
        """The narrowest part of the sheet, beside the hole, mm."""
        return min(self.width_mm, self.height_mm) / 2.0 - self.hole_radius_mm

    @property
    def size_mm(self) -> float:
        """The largest in-plane extent, mm."""
        return max(self.width_mm, self.height_mm)


class AnnulusSheet(Sheet):
    """A ring between two circles about the origin."""

    edge_names: ClassVar[tuple[str, ...]] = ("inner", "outer")
    shape: Literal["annulus"] = "annulus"
    inner_radius_mm: Length = 62.5
    outer_radius_mm: Length = 250.0

    @property
    def smallest_width_mm(self) -> float:
        """The width of the ring, mm."""
        return self.outer_radius_mm - self.inner_radius_mm

    @property
    def size_mm(self) -> float:
        """The largest in-plane extent, mm."""
        return 2.0 * self.outer_radius_mm


AnySheet = RectangleSheet | HoleSheet | AnnulusSheet
SHAPES: dict[str, type[RectangleSheet] | type[HoleSheet] | type[AnnulusSheet]] = {
    "rectangle": RectangleSheet,
    "annulus": AnnulusSheet,
    "rectangle-with-hole": HoleSheet,
}


class Material(Table):
    """An isotropic material in plane stress."""

    young_MPa: float = Field(default=3500.0, ge=1e-9, le=1e9, description="a modulus in MPa from 1e-9 to 1e9")
    poisson: float = Field(default=0.31, gt=-1.0, le=0.5, description="a number above -1 and at most 0.5")


class Edge(Table):
    """Support of one edge and where it goes: grown, then turned about the z axis, then moved."""

    support: Literal["free", "pinned", "clamped"] = "free"
    move_mm: Vector = (0.0, 0.0, 0.0)
    rotate_deg: float = Field(
        default=0.0, ge=-36000.0, le=36000.0, description="an angle from -36000 to 36000 degrees"
    )
    grow_mm: Annotated[Distance, Field(description="a finite number in mm from -1e9 to 1e9")] = 0.0


class Start(Table):
    """Where an iteration starts: a random perturbation, or (`from`) a result folder or a buckling mode."""

    perturbation: float = Field(
        default=1e-6, ge=0.0, le=0.1, description="a number from 0 to 0.1, a part of the sheet's size"
    )
    source: Annotated[str | None, BeforeValidator(_printable)] = Field(
        default=None,
        alias="from",
        min_length=1,
        max_length=4096,
        description='a result folder or "mode:1", "mode:2", ...',
    )


class Effects(Table):
    """Which effects the model keeps; what a method's model excludes is off."""

    out_of_plane: Switch = "auto"
    bending: Switch = "auto"
    strain_gradient: Switch = "auto"
    kinematics: Literal["finite", "moderate"] = "finite"


class Symmetry(Table):
    """The part of the sheet that is solved, and how z continues across the cut.

    "auto" solves a part where nothing is assumed by it, and else the whole sheet.
    """

    reduce: Reduction = "auto"
    parity: Literal["even", "odd"] = "even"

    @property
    def asked(self) -> bool:
        """Whether the scene itself asks for a part of the sheet."""
        return self.reduce not in ("auto", "none")


class Mesh(Table):
    """Number of nodes, and how strongly they gather (at a rectangle's centre lines, at an inner circle).

    An absent bias is the shape's own: 0 for a rectangle, 1 for the others. `vertices` takes the place of `nodes` for
    the finite-element methods; absent, they choose. `cell_ratio` is the height of a rectangle's cells over their
    width, 1 if absent.
    """

    nodes: int = Field(
        default=20_000,
        ge=SMALLEST_NODES,
        le=LARGEST_NODES,
        description=f"a whole number from {SMALLEST_NODES} to {LARGEST_NODES}",
    )
    bias: Bias = None
    cell_ratio: float | None = Field(default=None, ge=0.1, le=10.0, description="a number from 0.1 to 10")
    vertices: int | None = Field(
        default=None,
        ge=SMALLEST_NODES,
        le=LARGEST_NODES,
        description=f"a whole number from {SMALLEST_NODES} to {LARGEST_NODES}",
    )


class Solver(Table):
    """The iteration; absent tolerance and levels are chosen by the method."""

    tolerance: float | None = Field(
        default=None, ge=1e-14, le=0.1, description="a residual from 1e-14 to 0.1"
    )
    damping: Literal["adaptive", "kinetic", "kinetic-published", "viscous"] = "adaptive"
    mass: Literal["nodal", "isotropic", "uniform"] = "nodal"
    levels: int | None = Field(default=None, ge=1, le=12, description="a whole number from 1 to 12")
    thicken: bool = False
    thinning: Annotated[
        tuple[Annotated[float, Field(gt=1.0, le=1e4)], ...],
        BeforeValidator(_tuple_of),
        Field(max_length=20, description="up to 20 multiples of the thickness, above 1 and at most 10000"),
    ] = ()
    max_steps: int = Field(
        default=2_000_000, ge=1, le=10**12, description="a whole number from 1 to 1000000000000"
    )
    max_seconds: float = Field(
        1800.0, gt=0.0, le=1e8, description="a positive number of seconds, at most 1e8"
    )
    snapshots: int = Field(default=0, ge=0, le=1000, description="a whole number from 0 to 1000")
    published: Literal["printed", "filtered", "stabilised"] = "filtered"
    finish: Literal["auto", "on", "off"] = "auto"
    prestress: Literal["linear", "finite"] = "linear"
    element: Literal["argyris", "bogner-fox-schmit", "morley"] = "argyris"


class Line(Table):
    """A straight line from `from_mm` to `to_mm`, or the circle of `radius_mm` about the origin."""

    start_mm: Point | None = Field(default=None, alias="from_mm", description=POINT)
    end_mm: Point | None = Field(default=None, alias="to_mm", description=POINT)
    radius_mm: Length | None = Field(default=None, description=LENGTH)


@dataclass(frozen=True)
class Scene:
    """A complete scene: every key has its value, every edge of the shape is present.

    name : built-in name or stem of the file; names the result folder.
    assumed : dotted keys of the sheet and the material that the file left to their defaults.
    """

    name: str
    title: str
    sheet: AnySheet
    material: Material
    edges: dict[str, Edge]
    start: Start
    effects: Effects
    symmetry: Symmetry
    mesh: Mesh
    solver: Solver
    sections: dict[str, Line]
    paths: dict[str, Line]
    assumed: tuple[str, ...] = ()
