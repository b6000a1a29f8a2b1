"""A study of a fingertip as files: skin, recordings, sensels and maps, as `../shared/studies` has them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from trial.fingertips.pressure_mats import Mat
from trial.fingertips.tips import RADIUS_MM, Tip
from trial.worlds.finite_element_pads import half_ellipsoid, ply

PITCH_MM, FLOOR_KPA = 2.0, 0.6


@dataclass(frozen=True)
class Recording:
    """One file: its name, protocol, tool, place in the order, and columns by name."""

    name: str
    protocol: str
    tool: str
    order: int
    columns: dict


@dataclass(frozen=True)
class Frames:
    """A mat's frames: protocol, tool, and (phase, depth mm, slide mm, readings by row and col) of each."""

    protocol: str
    tool: str
    mat: Mat
    frames: list


@dataclass(frozen=True)
class Case:
    """A study: the tip (`pad`), what was recorded, in order, the mats' frames, and the coefficient of friction."""

    pad: Tip
    recordings: list
    maps: list
    friction: float

    def write(self, folder):
        """Writes `study.toml`, `skin.ply`, recordings, sensels and maps."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "skin.ply").write_text(ply(*half_ellipsoid(self.pad.semi_axes_mm, 0.17 * self.pad.thickness_mm)))
        text = '[study]\ntitle = "Fingertip"\n[skin]\nmesh = "skin.ply"\n[skin.materials.default]\n'
        text += f"g0_mpa = 0.006\ng_lim_mpa = 0.05\nd_lim_mm = 4.0\nthickness_mm = {self.pad.thickness_mm:.2f}\n"
        text += '[indenters.plate]\nshape = "plane"\n[indenters.cylinder]\nshape = "cylinder"\n'
        text += f"radius_mm = {self.pad.size * RADIUS_MM:.4f}\naxis = [0.0, 1.0, 0.0]\n"
        text += f"[sites.apex]\npoint_mm = [0.0, 0.0, {self.pad.semi_axes_mm[2]:.5f}]\ndirection = [0.0, 0.0, -1.0]\n"
        text += f"[instrument]\ngain_percent = 3.0\nnoise_n = 0.005\nthreshold_kpa = {FLOOR_KPA}\n"
        text += f"pitch_mm = {PITCH_MM}\nposition_mm = 0.5\n"
        for number, one in enumerate(self.recordings):
            head = ",".join(one.columns)
            table = np.column_stack(list(one.columns.values()))
            np.savetxt(folder / f"r{number:02d}.csv", table, "%.4f", delimiter=",", header=head, comments="")
            text += f'[[recordings]]\nname = "{one.name}"\nkind = "indentation"\nfile = "r{number:02d}.csv"\n'
            text += f'indenter = "{one.tool}"\nsite = "apex"\nprotocol = "{one.protocol}"\norder = {one.order}\n'
        for number, one in enumerate(self.maps):
            self._write_map(folder, number, one)
            text += f'[[recordings]]\nname = "map {one.protocol}"\nkind = "pressure_map"\nfile = "map{number}.csv"\n'
            text += f'sensels = "sensels{number}.csv"\nindenter = "{one.tool}"\nsite = "apex"\n'
            text += f'protocol = "{one.protocol}"\n'
        (folder / "study.toml").write_text(text)

    def _write_map(self, folder, number, one):
        at, top = one.mat.stated(), self.pad.semi_axes_mm[2]
        radius = self.pad.size * RADIUS_MM
        lines = ["row,col,x_mm,y_mm,z_mm,area_mm2"]
        index = [(row, col) for col in range(at.shape[1]) for row in range(at.shape[0])]
        for row, col in index:
            x, y = at[row, col]
            z = top
            if one.tool == "cylinder":
                x, z = radius * np.sin(x / radius), top + radius * (1.0 - np.cos(x / radius))
            lines.append(f"{row},{col},{x:.4f},{y:.4f},{z:.4f},{one.mat.pitch_mm**2:.4f}")
        (folder / f"sensels{number}.csv").write_text("\n".join(lines) + "\n")
        lines = ["frame,phase,depth_mm,slide_mm,row,col,pressure_kpa"]
        for frame, (phase, depth, slide, read) in enumerate(one.frames):
            lines += [f"{frame},{phase},{depth:.4f},{slide:.4f},{r},{c},{read[r, c]:.3f}" for r, c in index]
        (folder / f"map{number}.csv").write_text("\n".join(lines) + "\n")
