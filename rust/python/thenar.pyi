"""Contact of soft skin with products: forces, pressures and shapes, in mm, N, MPa and s."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Protocol, Self, TypeAlias, TypedDict, final, overload, type_check_only

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Floats: TypeAlias = NDArray[np.float64]

@type_check_only
class _IsSet(Protocol):
    def is_set(self) -> bool: ...

_Cancel: TypeAlias = Callable[[], bool] | _IsSet
_Progress: TypeAlias = Callable[[str, float], object]

class ThenarError(Exception):
    """Anything that thenar refuses; the message says what, where, and the remedy."""

class MeshError(ThenarError):
    """A mesh, or an array that belongs to one, cannot be used."""

class MaterialError(ThenarError):
    """A material number is not admissible, or a region has no material."""

class SolveError(ThenarError):
    """A press was asked for something it cannot do, or was not solved; `vertices` of the hand say where."""

    vertices: list[int]

class RecordingError(ThenarError):
    """A recording or study file cannot be used."""

class Cancelled(ThenarError):
    """The caller asked to stop."""

class Record(dict[str, Any]):
    """A dict whose entries are attributes too."""

    def __getattr__(self, name: str) -> Any: ...

@final
class Material:
    """Soft tissue of one region; numbers not given take the defaults of `parameters()`. Raises `MaterialError`."""

    def __new__(
        cls,
        *,
        g0_mpa: float | None = None,
        g_lim_mpa: float | None = None,
        d_lim_mm: float | None = None,
        thickness_mm: float | None = None,
        poisson_ratio: float | None = None,
        stiffening: float | None = None,
        bone_half_width_mm: float | None = None,
        bone_half_length_mm: float | None = None,
        zone_mm: float | None = None,
        swelling: tuple[float, float, float] | None = None,
        swelling_height_mm_per_n: float | None = None,
        swelling_radius_mm: float | None = None,
        swelling_width_mm: float | None = None,
    ) -> Self: ...
    @staticmethod
    def finger() -> Material: ...
    @staticmethod
    def palm() -> Material: ...
    @staticmethod
    def finger_layer() -> Material: ...
    @staticmethod
    def phalanx_layer() -> Material: ...
    @staticmethod
    def palm_layer() -> Material: ...
    def replace(self, **numbers: float | tuple[float, float, float]) -> Material: ...
    @property
    def g0_mpa(self) -> float: ...
    @property
    def g_lim_mpa(self) -> float: ...
    @property
    def d_lim_mm(self) -> float: ...
    @property
    def thickness_mm(self) -> float: ...
    @property
    def poisson_ratio(self) -> float: ...
    @property
    def stiffening(self) -> float: ...
    @property
    def bone_half_width_mm(self) -> float: ...
    @property
    def bone_half_length_mm(self) -> float: ...
    @property
    def zone_mm(self) -> float: ...
    @property
    def swelling(self) -> tuple[float, float, float]: ...
    @property
    def swelling_height_mm_per_n(self) -> float: ...
    @property
    def swelling_radius_mm(self) -> float: ...
    @property
    def swelling_width_mm(self) -> float: ...
    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]: ...

@type_check_only
class _GripPreset(TypedDict):
    name: str
    title: str
    youngs_mpa: float
    poisson_ratio: float
    source: str

@final
class Elastomer:
    """A soft layer bonded to the rigid core of a product: thickness in mm, Young's modulus in MPa, linear elastic."""

    def __new__(cls, thickness_mm: float, youngs_mpa: float, poisson_ratio: float = 0.49) -> Self: ...
    @staticmethod
    def of_shore_a(hardness: float, thickness_mm: float, poisson_ratio: float = 0.49) -> Elastomer: ...
    @staticmethod
    def presets() -> list[_GripPreset]: ...
    @property
    def thickness_mm(self) -> float: ...
    @property
    def youngs_mpa(self) -> float: ...
    @property
    def poisson_ratio(self) -> float: ...
    def __getnewargs__(self) -> tuple[float, float, float]: ...

@type_check_only
class _Gaps(TypedDict):
    gap_mm: _Floats
    closest_mm: _Floats
    normal: _Floats
    triangle: NDArray[np.int64]

@final
class Product:
    """A mesh prepared once for many presses and distance queries: vertices (n, 3) mm, triangles (m, 3)."""

    def __new__(cls, vertices_mm: ArrayLike, triangles: ArrayLike) -> Self: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def is_sheet(self) -> NDArray[np.bool_]: ...
    def gap_mm(
        self,
        points_mm: ArrayLike,
        skin_normals: ArrayLike | None = None,
        cut_off_mm: float | None = None,
        max_depth_mm: float | None = None,
        *,
        cancel: _Cancel | None = None,
        progress: _Progress | None = None,
    ) -> _Gaps: ...

@final
class Skin:
    """A hand prepared once and pressed in any posture: vertices (n, 3) mm, triangles (m, 3), regions (n,) or None.

    Several threads may press one skin at once.
    """

    def __new__(
        cls,
        vertices_mm: ArrayLike,
        triangles: ArrayLike,
        regions: ArrayLike | None = None,
        materials: Material | Sequence[Material] | Mapping[int | str, Material] | None = None,
        model: Literal["layer", "paper"] = "layer",
        *,
        region_names: Sequence[str] | None = None,
        effects: Sequence[Effect] | None = None,
        cancel: _Cancel | None = None,
        progress: _Progress | None = None,
    ) -> Self: ...
    @property
    def model(self) -> Literal["layer", "paper"]: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def materials(self) -> list[Material]: ...
    @property
    def region_names(self) -> list[str]: ...
    @overload
    def press(
        self,
        product_vertices_mm: Product,
        product_triangles: None = None,
        posed_vertices_mm: ArrayLike | None = None,
        force_n: float | None = None,
        direction: ArrayLike | None = None,
        cancel: _Cancel | None = None,
        progress: _Progress | None = None,
        *,
        slide_mm: ArrayLike | None = None,
        twist_rad: ArrayLike | None = None,
        drag_n: ArrayLike | None = None,
        warm_start: bool = False,
        live: bool = False,
        keep_unsolved: bool = False,
        grip: Elastomer | Sequence[Elastomer] | None = None,
        grip_of_vertex: ArrayLike | None = None,
    ) -> Contact: ...
    @overload
    def press(
        self,
        product_vertices_mm: ArrayLike,
        product_triangles: ArrayLike,
        posed_vertices_mm: ArrayLike | None = None,
        force_n: float | None = None,
        direction: ArrayLike | None = None,
        cancel: _Cancel | None = None,
        progress: _Progress | None = None,
        *,
        slide_mm: ArrayLike | None = None,
        twist_rad: ArrayLike | None = None,
        drag_n: ArrayLike | None = None,
        warm_start: bool = False,
        live: bool = False,
        keep_unsolved: bool = False,
        grip: Elastomer | Sequence[Elastomer] | None = None,
        grip_of_vertex: ArrayLike | None = None,
    ) -> Contact: ...
    @overload
    def run(
        self,
        protocol: dict[str, ArrayLike],
        product_vertices_mm: Product,
        product_triangles: None = None,
        posed_vertices_mm: ArrayLike | None = None,
        direction: ArrayLike | None = None,
        effects: Sequence[Effect] | None = None,
        cancel: _Cancel | None = None,
        progress: _Progress | None = None,
        *,
        keep: Literal["totals", "pressure", "loads"] = "totals",
    ) -> Course: ...
    @overload
    def run(
        self,
        protocol: dict[str, ArrayLike],
        product_vertices_mm: ArrayLike,
        product_triangles: ArrayLike,
        posed_vertices_mm: ArrayLike | None = None,
        direction: ArrayLike | None = None,
        effects: Sequence[Effect] | None = None,
        cancel: _Cancel | None = None,
        progress: _Progress | None = None,
        *,
        keep: Literal["totals", "pressure", "loads"] = "totals",
    ) -> Course: ...
    @property
    def thickness_mm(self) -> _Floats: ...
    @overload
    def start(
        self, product_vertices_mm: Product, product_triangles: None = None, direction: ArrayLike | None = None
    ) -> Walk: ...
    @overload
    def start(
        self, product_vertices_mm: ArrayLike, product_triangles: ArrayLike, direction: ArrayLike | None = None
    ) -> Walk: ...
    @property
    def effects(self) -> list[Effect]: ...
    def set_effects(self, effects: Sequence[Effect]) -> None: ...
    def with_effects(self, effects: Sequence[Effect]) -> Skin: ...

@final
class Effect:
    """Physics beyond the base model, by its name in `effects()`; amplitude 0 is the base model bit for bit."""

    def __new__(
        cls,
        name: str,
        amplitude: float = 1.0,
        *,
        regions: Sequence[int] | None = None,
        painted: ArrayLike | None = None,
        **numbers: float | str,
    ) -> Self: ...
    @property
    def name(self) -> str: ...
    @property
    def amplitude(self) -> float: ...
    @property
    def regions(self) -> list[int] | None: ...
    @property
    def painted(self) -> _Floats | None: ...
    @property
    def numbers(self) -> dict[str, float | str]: ...
    def with_amplitude(self, amplitude: float) -> Effect: ...
    def __getnewargs_ex__(self) -> tuple[tuple[str, float], dict[str, Any]]: ...

@final
class Walk:
    """A protocol followed row by row, begun by `Skin.start`; posture and product may move between rows."""

    def advance(
        self,
        time_s: float,
        posed_vertices_mm: ArrayLike | None = None,
        product_motion: ArrayLike | None = None,
        *,
        offset_mm: float | None = None,
        depth_mm: float | None = None,
        force_n: float | None = None,
        slide_mm: ArrayLike | None = None,
        cancel: _Cancel | None = None,
        progress: _Progress | None = None,
    ) -> Contact: ...
    def copy(self) -> Walk: ...
    @property
    def rows(self) -> int: ...
    @property
    def time_s(self) -> float: ...
    @property
    def offset_mm(self) -> float: ...
    @property
    def slip_loss_mj(self) -> float: ...
    @property
    def work_mj(self) -> float: ...
    @property
    def direction(self) -> _Floats: ...

@final
class Course:
    """The result of a protocol; arrays have one entry per row."""

    @property
    def time_s(self) -> _Floats: ...
    @property
    def offset_mm(self) -> _Floats: ...
    @property
    def depth_mm(self) -> _Floats: ...
    @property
    def force_n(self) -> _Floats: ...
    @property
    def total_force_n(self) -> _Floats: ...
    @property
    def tangential_force_n(self) -> _Floats: ...
    @property
    def slip_loss_mj(self) -> _Floats: ...
    @property
    def contact_area_mm2(self) -> _Floats: ...
    @property
    def peak_pressure_mpa(self) -> _Floats: ...
    @property
    def region_force_n(self) -> _Floats: ...
    @property
    def work_mj(self) -> _Floats: ...
    @property
    def pressure_mpa(self) -> _Floats | None: ...
    @property
    def loads(self) -> list[_Floats] | None: ...
    @property
    def cycles(self) -> list[Record]: ...
    @property
    def has_converged(self) -> NDArray[np.bool_]: ...
    @property
    def direction(self) -> _Floats: ...
    @property
    def last(self) -> Contact: ...

@final
class Contact:
    """The result of a press; arrays over vertices are in the order of the skin's vertices."""

    @property
    def displacement_mm(self) -> _Floats: ...
    @property
    def pressure_mpa(self) -> _Floats: ...
    @property
    def force_n(self) -> _Floats: ...
    @property
    def grip_displacement_mm(self) -> _Floats | None: ...
    @property
    def pressed_product(self) -> Product | None: ...
    @property
    def gap_mm(self) -> _Floats: ...
    @property
    def in_contact(self) -> NDArray[np.bool_]: ...
    @property
    def product_normal(self) -> _Floats: ...
    @property
    def total_force_n(self) -> _Floats: ...
    @property
    def total_moment_nmm(self) -> _Floats: ...
    @property
    def center_of_pressure_mm(self) -> _Floats: ...
    @property
    def contact_area_mm2(self) -> float: ...
    @property
    def peak_pressure_mpa(self) -> float: ...
    @property
    def mean_pressure_mpa(self) -> float: ...
    @property
    def patch_peak_mpa(self) -> float: ...
    @property
    def regions(self) -> list[Record]: ...
    @property
    def product_pressure_mpa(self) -> _Floats: ...
    @property
    def offset_mm(self) -> float: ...
    @property
    def direction(self) -> _Floats: ...
    @property
    def adhesion_force_n(self) -> _Floats: ...
    @property
    def tangential_force_n(self) -> _Floats: ...
    @property
    def tangential_traction_mpa(self) -> _Floats: ...
    @property
    def slip_mm(self) -> _Floats: ...
    @property
    def slip_margin(self) -> _Floats: ...
    @property
    def is_sticking(self) -> NDArray[np.bool_]: ...
    @property
    def friction(self) -> Record | None: ...
    @property
    def residual(self) -> Record: ...
    @property
    def convergence(self) -> Record: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def grade(self) -> Literal["good", "read this", "do not use"]: ...
    @property
    def reason(self) -> str | None: ...
    @property
    def remarks(self) -> list[Record]:
        """One per warning: kind, grade, text, and the vertex and the region it is about, None where there is none."""
    @property
    def seconds(self) -> Record: ...

@final
class Mat:
    """A mat of sensels, flat or wrapped, that averages pressure over each sensel. Raises `MeshError`."""

    def __new__(
        cls,
        centers_mm: ArrayLike,
        areas_mm2: ArrayLike,
        normals: ArrayLike | None = None,
        along: ArrayLike | None = None,
    ) -> Self: ...
    def __len__(self) -> int: ...
    def read(self, contact: Contact | ArrayLike, vertices_mm: ArrayLike | None = None) -> _Floats: ...
    def force_n(self, frame_kpa: ArrayLike) -> float: ...
    def area_mm2(self, frame_kpa: ArrayLike, threshold_kpa: float = 0.0) -> float: ...
    @property
    def centers_mm(self) -> _Floats: ...
    @property
    def normals(self) -> _Floats: ...
    @property
    def areas_mm2(self) -> _Floats: ...
    @property
    def flat_mm(self) -> _Floats: ...

@final
class Study:
    """Recordings, and the skin, tools and places they were taken with, in mm, N, s, kPa for maps and MPa for moduli."""

    @staticmethod
    def load(folder: str | PathLike[str]) -> Study:
        """Loads the study in `folder` with every file it names. Raises `RecordingError`."""

    def recording(self, name: str) -> Record: ...
    @property
    def folder(self) -> Path: ...
    @property
    def title(self) -> str: ...
    @property
    def skin(self) -> Record: ...
    @property
    def indenters(self) -> Record: ...
    @property
    def sites(self) -> Record: ...
    @property
    def recordings(self) -> list[Record]: ...
    @property
    def instrument(self) -> Record | None: ...
    @property
    def warnings(self) -> list[str]: ...

@final
class Comparison:
    """What separates simulation and recordings; a residual is measured minus simulated."""

    def to_json(self) -> str:
        """comparison.json, schema 1."""
    def report_html(self) -> str:
        """A self-contained page with plots."""
    @property
    def title(self) -> str: ...
    @property
    def sentence(self) -> str:
        """What a designer reads first."""
    @property
    def lack_of_fit_p(self) -> float | None: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def estimates(self) -> list[Record]: ...
    @property
    def recordings(self) -> list[Record]:
        """By recording: sentence, measures, series, mat, frames, scan, print, worst, residual_kpa, unknown."""

def compare(
    study: Study,
    progress: _Progress | None = None,
    cancel: _Cancel | None = None,
    *,
    seed: int = 1,
) -> Comparison:
    """Fits a study's parameters to its recordings and compares what is left. Raises `RecordingError`, `Cancelled`."""

@final
class Diagnosis:
    """What a study's recordings show that the model leaves out."""

    def to_json(self) -> str:
        """findings.json, schema 1; `suspected` lists effects that are suspected and are no findings."""
    def report_html(self) -> str:
        """A self-contained page: the diagnosis, then the comparison that it started from."""
    @property
    def sentence(self) -> str:
        """What a designer reads first."""
    @property
    def verdict(self) -> str:
        """The verdict's word, as in findings.json."""
    @property
    def suspected(self) -> list[str]:
        """Effects that explain more than noise would and that a gate refused: suspected only, no findings.

        With insufficient_data no gate was asked and the noise is not known; friction of a single slide passes no gate.
        """
    @property
    def curves(self) -> list[Record]:
        """By recording: time_s, depth_mm, measured_n, before_n (parameters alone), after_n (with what was found)."""

def diagnose(
    study: Study,
    progress: _Progress | None = None,
    cancel: _Cancel | None = None,
    *,
    seed: int = 1,
) -> Diagnosis:
    """Says what physics a study's recordings show that the model leaves out. Raises `RecordingError`, `Cancelled`."""

def place_mat(
    file: str | PathLike[str] | Print,
    on: Literal["plane", "cylinder"],
    *,
    origin_mm: ArrayLike,
    rows: ArrayLike,
    columns: ArrayLike,
    diameter_mm: float | None = None,
    turn: Literal["right", "left"] = "right",
    mat: str | None = None,
) -> Record:
    """Where the sensels of a mat come to lie: center_mm, normal, area_mm2, row, column. Raises `RecordingError`."""

def compare_map(
    values: ArrayLike,
    mat: Record,
    vertices_mm: ArrayLike,
    triangles: ArrayLike,
    force_n: ArrayLike,
    *,
    name: str = "recording",
    product: str = "product",
    hand: str = "hand",
    calibrated: bool = True,
    threshold: float | None = None,
    clipped_from: float | None = None,
    noise: float | None = None,
    time_s: float = 0.0,
    unknown: list[str] = ...,
) -> Comparison:
    """Compares one frame of a mat with a solved contact, sensel by sensel. Raises `MeshError`, `RecordingError`."""

@final
class Print:
    """The image of a print in ink as shares of ink by cell; columns from left to right, rows from the lower edge up."""

    @staticmethod
    def read(
        file: str | PathLike[str],
        *,
        dpi: float | None = None,
        mm_per_px: float | None = None,
        marks_px: tuple[tuple[float, float], tuple[float, float]] | None = None,
        marks_mm: float | None = None,
        cell_mm: float = 2.5,
        threshold: float | None = None,
        ink: Literal["dark", "light"] | None = None,
        paper_px: tuple[float, float, float, float] | None = None,
        mirrored: bool = False,
    ) -> Print:
        """Reads a PNG, JPEG or TIFF; what is transparent is no paper. Raises `RecordingError`."""
    @property
    def inked(self) -> NDArray[np.float64]:
        """Share of ink by cell (n,), NaN where less than half of the cell is paper."""
    @property
    def cells(self) -> tuple[int, int]:
        """Rows and columns."""
    @property
    def cell_mm(self) -> float: ...
    @property
    def mm_per_px(self) -> float: ...
    @property
    def size_px(self) -> tuple[int, int]: ...
    @property
    def inked_mm2(self) -> float: ...
    @property
    def threshold(self) -> float: ...
    @property
    def ink(self) -> Literal["dark", "light"]: ...
    @property
    def unknown(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...

def compare_print(
    print: Print,
    mat: Record,
    vertices_mm: ArrayLike,
    triangles: ArrayLike,
    force_n: ArrayLike,
    *,
    ink_kpa: float = 0.0,
    regions: list[int] | None = None,
    region_names: list[str] = ...,
    name: str = "print",
    product: str = "product",
    hand: str = "hand",
) -> Comparison:
    """Compares a print with a solved contact; only the paper's pose is fitted. Raises `MeshError`, `RecordingError`."""

def spread_map(values: ArrayLike, mat: Record, positions_mm: ArrayLike, depth_mm: float = 0.0) -> NDArray[np.float64]:
    """Values of sensels at positions on the mat or near it, NaN away from it. Raises `MeshError`."""

def read_recording(
    file: str | PathLike[str], *, columns: dict[str, str] | None = None, run: str | None = None
) -> Record:
    """Reads a measurement file of any maker: `format`, `maps`, `curves` and `notes`. Raises `RecordingError`."""

def hand(
    length_mm: float | None = None,
    breadth_mm: float | None = None,
    percentile: float | None = None,
    sex: Literal["male", "female"] = "male",
    side: Literal["right", "left"] = "right",
    spacing_mm: float | None = None,
    *,
    cancel: _Cancel | None = None,
) -> Record: ...
def reference_press(
    posed_vertices_mm: ArrayLike,
    triangles: ArrayLike,
    bone_mm: ArrayLike,
    shear_modulus_mpa: ArrayLike,
    product_vertices_mm: ArrayLike | Product,
    product_triangles: ArrayLike | None = None,
    *,
    held: Sequence[bool] | None = None,
    can_touch: Sequence[bool] | None = None,
    stiffening: ArrayLike | None = None,
    layers: int = 3,
    bulk_ratio: float = 100.0,
    cancel: _Cancel | None = None,
    progress: _Progress | None = None,
) -> Record:
    """Presses soft tissue, meshed from the skin to the bone, at finite strain: the reference of model "layer".

    `can_touch` (n,): vertices that the product can touch. `cut_mm` and `cut_share` of the record: how deep the product
    lies in the skin between vertices, and with how much of the overlap.

    Raises `MeshError`, `SolveError`, `Cancelled`.
    """

def bone_points(
    vertices_mm: ArrayLike,
    triangles: ArrayLike,
    thickness_mm: ArrayLike,
    heads_mm: ArrayLike | None = None,
    tails_mm: ArrayLike | None = None,
    palmar: ArrayLike | None = None,
    is_last: Sequence[bool] | None = None,
    weights: ArrayLike | None = None,
) -> _Floats:
    """Point of the bone under every vertex of a hand at rest, as `reference_press` needs it. Raises `MeshError`."""

def press_ball(
    radius_mm: float,
    depths_mm: ArrayLike,
    thickness_mm: float,
    poisson_ratio: float = 0.5,
    *,
    skin_mm: float = 0.0,
    skin_ratio: float = 1.0,
) -> NDArray[np.float64]:
    """Forces over the shear modulus (mm2) of a ball on a flat layer, bare or under a stiff skin that stretches."""

def solve_complementarity(matrix: ArrayLike, gap: ArrayLike) -> NDArray[np.float64]: ...
def solve_stick_slip(matrix: ArrayLike, travel_mm: ArrayLike, limit_n: ArrayLike) -> Record: ...
def observe(signals: Mapping[str, Any], mat: Mat | None = None, effects: Sequence[Effect] | None = None) -> Record:
    """What a measuring set-up shows of what happens at the skin: channels after the instrument effects."""

def parquet(columns: dict[str, Sequence[float | None] | Sequence[str | None]]) -> bytes:
    """The bytes of an Apache Parquet file with these columns, all of one length. Raises `ValueError`."""

def parameters() -> list[Record]:
    """The table of material numbers: name, symbol, unit, default, low, high, meaning, source."""

def effects() -> list[Record]:
    """The catalogue of effects, in the order in which they compose: meaning, shape numbers, consequences, source."""

def build_info() -> Record:
    """Version, target, profile, abi and threads of the native module."""
