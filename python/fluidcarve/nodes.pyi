# Written by `python -m fluidcarve.stubs` from the program's own node types.
from typing import Any, Literal, Mapping, Sequence

from .pipeline import Node, Output, Param, Source


class EnergyAx(Node):
    energy: Output

class EnergyCombine(Node):
    energy: Output

class EnergyCurvature(Node):
    energy: Output

class EnergyGradient(Node):
    energy: Output

class EnergyImage(Node):
    energy: Output
    intensity: Output

class EnergyKinetic(Node):
    energy: Output

class EnergyPython(Node):
    energy: Output

class EnergyRemap(Node):
    energy: Output

class EnergySurface(Node):
    energy: Output

class EnergyVolume(Node):
    energy: Output

class EnergyVorticity(Node):
    energy: Output

class EnergyFamily:
    def ax(
        self,
        inputs: Mapping[str, Source],
        code: bool | float | str | Param,
        *,
        name: str = ...,
        params: Mapping[str, Any] | Param = ...,
        outside: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyAx:
        """
        An energy computed by your own program, in OpenVDB AX, where the built-in energies are not enough.
        """
    def combine(
        self,
        terms: Source | Sequence[Source],
        *,
        name: str = ...,
        weights: Sequence[float | Param] | Param = ...,
        range: Sequence[Sequence[float | Param] | Literal["auto"] | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyCombine:
        """
        Adds energies, each remapped to [0, 1] over the whole sequence and weighted.
        """
    def curvature(
        self,
        surface: Source,
        *,
        name: str = ...,
        gain: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyCurvature:
        """
        High where a surface curves, so that seams avoid its waves, drops and edges.
        """
    def gradient(
        self,
        field: Source,
        *,
        name: str = ...,
        gain: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyGradient:
        """
        High where a field changes, so that seams avoid its edges and details.
        """
    def image(
        self,
        source: Source,
        *,
        name: str = ...,
        channels: Sequence[bool | float | str | Param] | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyImage:
        """
        The paper's energy for images (equation 6): high where the intensity changes, so that seams avoid edges and
        textures.
        """
    def kinetic(
        self,
        velocity: Source,
        *,
        name: str = ...,
        gain: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyKinetic:
        """
        High where the flow is fast, so that seams avoid jets and bursts.
        """
    def python(
        self,
        inputs: Mapping[str, Source],
        script: str | Param,
        *,
        name: str = ...,
        params: Mapping[str, Any] | Param = ...,
        python: bool | float | str | Param = ...,
        timeout: float | Param = ...,
        halo: int | Literal["auto"] | Param = ...,
        outside: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyPython:
        """
        An energy computed by your own function in Python, `energy(d, ..., at)`, with numpy or what else you have.
        """
    def remap(
        self,
        energy: Source,
        *,
        name: str = ...,
        range: Sequence[float | Param] | Literal["auto"] | Param = ...,
        to: Sequence[float | Param] | Param = ...,
        gamma: float | Param = ...,
        clamp: bool | Param = ...,
        invert: bool | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyRemap:
        """
        Remaps an energy's values to another interval: linearly or with a gamma, and inverted if wanted.
        """
    def surface(
        self,
        surface: Source,
        *,
        name: str = ...,
        velocity: Source = ...,
        curvature: float | Param = ...,
        kinetic: float | Param = ...,
        range: Sequence[Sequence[float | Param] | Literal["auto"] | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergySurface:
        """
        The paper's energy for liquids and meshes: high where the surface curves, or the flow is fast.
        """
    def volume(
        self,
        *,
        name: str = ...,
        velocity: Source = ...,
        fields: Source | Sequence[Source] = ...,
        vorticity: float | Param = ...,
        kinetic: float | Param = ...,
        gradient: float | Param = ...,
        range: Sequence[Sequence[float | Param] | Literal["auto"] | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyVolume:
        """
        The paper's energy for smoke and fire: high where the flow spins, is fast, or its fields change.
        """
    def vorticity(
        self,
        velocity: Source,
        *,
        name: str = ...,
        gain: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> EnergyVorticity:
        """
        High where the flow spins, so that seams avoid vortices.
        """

class FieldAx(Node):
    out: Output

class FieldCollocate(Node):
    velocity: Output

class FieldCurl(Node):
    curl: Output

class FieldCurvature(Node):
    curvature: Output

class FieldFilter(Node):
    filtered: Output

class FieldGradient(Node):
    gradient: Output

class FieldLaplacian(Node):
    laplacian: Output

class FieldMagnitude(Node):
    magnitude: Output

class FieldPython(Node):
    out: Output

class FieldFamily:
    def ax(
        self,
        inputs: Mapping[str, Source],
        code: bool | float | str | Param,
        *,
        name: str = ...,
        params: Mapping[str, Any] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldAx:
        """
        A field computed by your own program, in OpenVDB AX: to mix, scale or cut fields before other nodes use them.
        """
    def collocate(
        self,
        velocity: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldCollocate:
        """
        Moves a staggered velocity from the voxels' faces to their centres.
        """
    def curl(
        self,
        velocity: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldCurl:
        """
        The curl of a velocity: the axis of the flow's rotation, and twice its rate.
        """
    def curvature(
        self,
        field: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldCurvature:
        """
        Curvature of a field's level surfaces: the sum of the two principal curvatures, div (grad field / |grad
        field|).
        """
    def filter(
        self,
        field: Source,
        *,
        name: str = ...,
        mode: Literal["gaussian", "mean", "median"] | Param = ...,
        width: int | Param = ...,
        iterations: int | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldFilter:
        """
        Smooths a field, so that an energy made of it follows its large shapes.
        """
    def gradient(
        self,
        field: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldGradient:
        """
        The gradient of a field: the direction and steepness of its rise.
        """
    def laplacian(
        self,
        field: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldLaplacian:
        """
        The Laplacian of a field, div grad: below 0 on peaks, above 0 in pits.
        """
    def magnitude(
        self,
        vectors: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldMagnitude:
        """
        The length of each vector: speed from velocity.
        """
    def python(
        self,
        inputs: Mapping[str, Source],
        script: str | Param,
        *,
        name: str = ...,
        params: Mapping[str, Any] | Param = ...,
        python: bool | float | str | Param = ...,
        timeout: float | Param = ...,
        halo: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FieldPython:
        """
        A field computed by your own function in Python, `field(d, ..., at)`.
        """

class FilterSeam(Node):
    volume: Output

class FilterFamily:
    def seam(
        self,
        source: Source,
        lattice: Source,
        seams: Source | Sequence[Source],
        *,
        name: str = ...,
        count: int | str | Param = ...,
        filter: Literal["gaussian", "mean", "median"] | Param = ...,
        width: int | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> FilterSeam:
        """
        Smooths a carved volume along the seams that were carved from it, and nowhere else.
        """

class GridCrop(Node):
    volume: Output

class GridPick(Node):
    volume: Output

class GridPrune(Node):
    volume: Output

class GridResample(Node):
    volume: Output

class GridFamily:
    def crop(
        self,
        source: Source,
        min: Sequence[float | Param] | Param,
        max: Sequence[float | Param] | Param,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> GridCrop:
        """
        Leaves of grids only what lies in a box.
        """
    def pick(
        self,
        source: Source,
        *,
        name: str = ...,
        keep: Sequence[bool | float | str | Param] | Param = ...,
        drop: Sequence[bool | float | str | Param] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> GridPick:
        """
        Keeps some grids of a volume, or drops them.
        """
    def prune(
        self,
        source: Source,
        *,
        name: str = ...,
        tolerance: float | Param = ...,
        below: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> GridPrune:
        """
        Makes grids smaller: takes out what hardly shows, and joins equal voxels to tiles.
        """
    def resample(
        self,
        source: Source,
        *,
        name: str = ...,
        like: Source = ...,
        voxel_size: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> GridResample:
        """
        Puts grids on other voxels: larger or smaller ones, upright cubes in place of turned ones, or those of another
        grid.
        """

class ImageRead(Node):
    volume: Output

class ImageWrite(Node):
    ...

class ImageFamily:
    def read(
        self,
        path: str | Param,
        *,
        name: str = ...,
        channels: Mapping[str, Any] | Param = ...,
        missing: Literal["error", "hold", "skip"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> ImageRead:
        """
        Reads images, or videos as sequences of images (PNG, EXR, JPEG, TIFF): one float grid per channel, one voxel
        of size 1 per pixel, the lower left pixel at [0, 0, 0]. Pictures are turned upright by the file's orientation.
        Values are not converted, except that integers are divided by the largest value of their depth.
        """
    def write(
        self,
        source: Source,
        path: str | Param,
        *,
        name: str = ...,
        channels: Sequence[bool | float | str | Param] | Literal["auto"] | Param = ...,
        depth: Literal["auto", "float", "half", "uint16", "uint8"] | Param = ...,
        quality: int | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> ImageWrite:
        """
        Writes images: the box of a volume's active voxels, one pixel per voxel, so that a carved image comes out
        narrower. Depth, channel names and attributes of the image that was read are kept as far as the format holds
        them. Values are not converted, except for opacity: colours are multiplied by it in EXR, and not in PNG. A
        file appears whole or not at all.
        """

class LatticeAround(Node):
    lattice: Output

class LatticeBox(Node):
    lattice: Output

class LatticeBuild(Node):
    lattice: Output

class LatticeWrite(Node):
    ...

class LatticeFamily:
    def around(
        self,
        rig: Source,
        spacing: float | Param,
        radius: float | Param,
        *,
        name: str = ...,
        smooth: Literal["directions", "none", "points"] | Param = ...,
        max_iterations: int | Param = ...,
        on_fold: Literal["error", "warn"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> LatticeAround:
        """
        Builds a lattice around a rig: `u` is the distance from the rig, and `v` runs around it and closes. Seams
        across `u` make a trail, a jet or a column of smoke thinner or thicker from all sides. A moving rig gets one
        lattice per frame, each with as many planes as the longest rig needs.
        """
    def box(
        self,
        *,
        name: str = ...,
        fit: Source | Sequence[Source] = ...,
        min: Sequence[float | Param] | Literal["auto"] | Param = ...,
        max: Sequence[float | Param] | Literal["auto"] | Param = ...,
        spacing: float | Literal["auto"] | Param = ...,
        axes: Literal["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> LatticeBox:
        """
        A straight lattice, given by its corners or fitted around the active voxels of a grid over all frames.
        """
    def build(
        self,
        rig: Source,
        extent_u: Sequence[bool | float | str | Param] | Sequence[float | Param] | Param,
        extent_v: Sequence[bool | float | str | Param] | Sequence[float | Param] | Param,
        *,
        name: str = ...,
        content: Source = ...,
        spacing: float | Literal["auto"] | Param = ...,
        flip_u: bool | Param = ...,
        mapping: Literal["closed_form", "exact"] | Param = ...,
        smooth: Literal["directions", "none", "points"] | Param = ...,
        max_iterations: int | Param = ...,
        on_fold: Literal["error", "warn"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> LatticeBuild:
        """
        Builds a lattice along a rig. Its planes stand across the rig, at equal distances, and do not twist. A moving
        rig gets one lattice per frame, each with as many planes as the longest rig needs.
        """
    def write(
        self,
        lattice: Source,
        path: str | Param,
        *,
        name: str = ...,
        every: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> LatticeWrite:
        """
        Writes a lattice as lines in an .obj file, to view it beside the data. Writes one file per frame if the
        lattice moves. Positions are those of the shot's world, with its axes. Blender turns OBJ files unless told
        otherwise: import them with Forward Y, Up Z.
        """

class MaskBelowSurface(Node):
    mask: Output

class MaskBox(Node):
    mask: Output

class MaskCombine(Node):
    mask: Output

class MaskDilate(Node):
    mask: Output

class MaskMesh(Node):
    mask: Output

class MaskPython(Node):
    mask: Output

class MaskSphere(Node):
    mask: Output

class MaskThreshold(Node):
    mask: Output

class MaskWeight(Node):
    energy: Output

class MaskFamily:
    def below_surface(
        self,
        surfaces: Source | Sequence[Source],
        *,
        name: str = ...,
        up: Sequence[float | Param] | Param = ...,
        depth: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskBelowSurface:
        """
        The voxels below the surfaces of liquids and their banks, where energy should not count (paper 6.0.2).
        """
    def box(
        self,
        like: Source,
        min: Sequence[float | Param] | Param,
        max: Sequence[float | Param] | Param,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskBox:
        """
        The voxels in a box: where seams are wanted, or kept out.
        """
    def combine(
        self,
        masks: Source | Sequence[Source],
        *,
        name: str = ...,
        mode: Literal["difference", "intersection", "union"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskCombine:
        """
        Combines masks to one: the voxels in any of them, in all, or only in the first.
        """
    def dilate(
        self,
        mask: Source,
        voxels: int | Param,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskDilate:
        """
        Grows or shrinks a mask: for example a margin around what must be spared.
        """
    def mesh(
        self,
        mesh: Source,
        like: Source,
        *,
        name: str = ...,
        where: Literal["inside", "near"] | Param = ...,
        distance: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskMesh:
        """
        The voxels in a mesh, or near its faces: where seams are wanted, or kept out.
        """
    def python(
        self,
        inputs: Mapping[str, Source],
        script: str | Param,
        *,
        name: str = ...,
        params: Mapping[str, Any] | Param = ...,
        python: bool | float | str | Param = ...,
        timeout: float | Param = ...,
        halo: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskPython:
        """
        A mask computed by your own function in Python, `mask(d, ..., at)`.
        """
    def sphere(
        self,
        like: Source,
        center: Sequence[float | Param] | Param,
        radius: float | Param,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskSphere:
        """
        The voxels in a sphere: where seams are wanted, or kept out.
        """
    def threshold(
        self,
        field: Source,
        *,
        name: str = ...,
        above: float | Literal["auto"] | Param = ...,
        below: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskThreshold:
        """
        The voxels with a value in a range: where the smoke is, or where it is hot.
        """
    def weight(
        self,
        energy: Source,
        masks: Source | Sequence[Source],
        weights: Sequence[float | Param] | Param,
        *,
        name: str = ...,
        outside: float | Param = ...,
        mode: Literal["assign", "multiply"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MaskWeight:
        """
        Weights an energy by regions: high weights keep seams away, also from empty space; low weights attract them.
        """

class MeshRead(Node):
    mesh: Output

class MeshWrite(Node):
    ...

class MeshFamily:
    def read(
        self,
        path: str | Param,
        *,
        name: str = ...,
        missing: Literal["error", "hold", "skip"] | Param = ...,
        translate: Sequence[float | Param] | Param = ...,
        scale: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MeshRead:
        """
        Reads polygon meshes: OBJ, PLY, OFF, STL, with UVs, normals, colours, groups and materials.
        """
    def write(
        self,
        source: Source,
        path: str | Param,
        *,
        name: str = ...,
        translate: Sequence[float | Param] | Literal["auto"] | Param = ...,
        scale: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> MeshWrite:
        """
        Writes polygon meshes: OBJ, PLY, OFF, STL, USD. A file appears whole or not at all.
        """

class PointsKeepOut(Node):
    points: Output

class PointsPython(Node):
    points: Output

class PointsRead(Node):
    points: Output

class PointsWrite(Node):
    ...

class PointsFamily:
    def keep_out(
        self,
        source: Source,
        solid: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> PointsKeepOut:
        """
        Moves particles inside a solid out to its surface, for example where a carve moved water and bank by slightly
        different amounts.
        """
    def python(
        self,
        inputs: Mapping[str, Source],
        script: str | Param,
        *,
        name: str = ...,
        params: Mapping[str, Any] | Param = ...,
        python: bool | float | str | Param = ...,
        timeout: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> PointsPython:
        """
        Particles changed, added or taken away by your own function in Python, `points(p, ..., at)`.
        """
    def read(
        self,
        path: str | Param,
        *,
        name: str = ...,
        grid: bool | float | str | Param = ...,
        missing: Literal["error", "hold", "skip"] | Param = ...,
        offset: Literal["auto", "half_voxel", "none"] | Param = ...,
        translate: Sequence[float | Param] | Param = ...,
        scale: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> PointsRead:
        """
        Reads points: particles with all their attributes, from VDB files or the vertices of PLY files.
        """
    def write(
        self,
        source: Source,
        path: str | Param,
        *,
        name: str = ...,
        beside: Source = ...,
        encoding: Literal["ascii", "auto", "big_endian", "little_endian"] | Param = ...,
        width: float | Literal["auto"] | Param = ...,
        translate: Sequence[float | Param] | Literal["auto"] | Param = ...,
        scale: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> PointsWrite:
        """
        Writes points to VDB files, alone or beside other grids, to PLY or to USD files. A file appears whole or not
        at all.
        """

class PreviewPage(Node):
    ...

class PreviewSheet(Node):
    ...

class PreviewFamily:
    def page(
        self,
        before: Source,
        path: str | Param,
        *,
        name: str = ...,
        energy: Source = ...,
        lattice: Source = ...,
        rig: Source = ...,
        masks: Mapping[str, Source] = ...,
        seams: Source | Sequence[Source] = ...,
        grid: bool | float | str | Param = ...,
        frames: int | Literal["auto"] | Param = ...,
        voxels: int | Literal["auto"] | Param = ...,
        count: int | str | Param = ...,
        rim: Literal["cut", "fade"] | Param = ...,
        rim_fade: float | Param = ...,
        setting: bool | float | str | Param = ...,
        join: Literal["auto", "cut", "fade", "squeeze"] | Param = ...,
        fade: float | Literal["auto"] | Param = ...,
        soft: float | Literal["auto"] | Param = ...,
        soft_time: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> PreviewPage:
        """
        A page for a browser, to choose the count by eye: the sequence before and after, with a slider. It is one file
        that loads nothing else. The page carves by itself, from the seams, as remap.grids does with linear
        interpolation. Without `seams` it shows where rig, lattice, masks and energy lie.
        """
    def sheet(
        self,
        before: Source,
        path: str | Param,
        *,
        name: str = ...,
        after: Source = ...,
        energy: Source = ...,
        lattice: Source = ...,
        rig: Source = ...,
        seams: Source = ...,
        grid: bool | float | str | Param = ...,
        axis: Literal["x", "y", "z"] | Param = ...,
        show: Sequence[Literal["both", "maximum", "render", "slice"] | Param] | Literal["both", "maximum", "render", "slice"] | Param = ...,
        slice: int | Literal["auto"] | Param = ...,
        exposure: float | Param = ...,
        overlay: Sequence[Literal["lattice", "rig", "seams"] | Param] | Literal["lattice", "rig", "seams"] | Param = ...,
        difference: bool | Param = ...,
        frames: int | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> PreviewSheet:
        """
        A picture to check a carve: a grid before and after, the difference and the seams, for some frames of the
        sequence. Frames go across. All pictures show the same area; rows of one kind share a colour scale, which is
        printed beside them. The world's axes are drawn at the upper right: a dot points at the viewer, a cross away.
        """

class RemapGrids(Node):
    volume: Output

class RemapMesh(Node):
    mesh: Output

class RemapPoints(Node):
    points: Output

class RemapFamily:
    def grids(
        self,
        source: Source,
        lattice: Source,
        seams: Source | Sequence[Source],
        *,
        name: str = ...,
        count: int | str | Param = ...,
        rim: Literal["cut", "fade"] | Param = ...,
        rim_fade: float | Param = ...,
        join: Literal["auto", "cut", "fade", "squeeze"] | Param = ...,
        fade: float | Literal["auto"] | Param = ...,
        soft: float | Literal["auto"] | Param = ...,
        soft_time: float | Param = ...,
        interpolation: Literal["cubic", "linear", "quadratic"] | Param = ...,
        renormalize: bool | Literal["auto"] | Param = ...,
        conserve: Literal["mass", "none"] | Param = ...,
        densities: Sequence[bool | float | str | Param] | Param = ...,
        transform_vectors: bool | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RemapGrids:
        """
        Carves seams from the grids of a volume, or inserts them: all at once, from the untouched input.
        """
    def mesh(
        self,
        source: Source,
        lattice: Source,
        seams: Source | Sequence[Source],
        *,
        name: str = ...,
        count: int | str | Param = ...,
        rim: Literal["cut", "fade"] | Param = ...,
        rim_fade: float | Param = ...,
        join: Literal["auto", "cut", "fade", "squeeze"] | Param = ...,
        fade: float | Literal["auto"] | Param = ...,
        soft: float | Literal["auto"] | Param = ...,
        soft_time: float | Param = ...,
        static: bool | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RemapMesh:
        """
        Carves a mesh as remap.grids carves volumes. Its vertices move with the space around them; faces, UVs and
        everything else stay.
        """
    def points(
        self,
        source: Source,
        lattice: Source,
        seams: Source | Sequence[Source],
        *,
        name: str = ...,
        count: int | str | Param = ...,
        rim: Literal["cut", "fade"] | Param = ...,
        rim_fade: float | Param = ...,
        join: Literal["auto", "cut", "fade", "squeeze"] | Param = ...,
        fade: float | Literal["auto"] | Param = ...,
        soft: float | Literal["auto"] | Param = ...,
        soft_time: float | Param = ...,
        jitter: float | Param = ...,
        transform_vectors: bool | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RemapPoints:
        """
        Carves seams from points, or inserts them. Particles move; those that a removed seam takes are deleted, and
        those where a seam is inserted are doubled.
        """

class RigAdvect(Node):
    rig: Output

class RigCircle(Node):
    rig: Output

class RigCurve(Node):
    rig: Output

class RigPoints(Node):
    rig: Output

class RigPython(Node):
    rig: Output

class RigTransform(Node):
    rig: Output

class RigFamily:
    def advect(
        self,
        velocity: Source,
        seed: Sequence[float | Param] | Param,
        radius: float | Param,
        *,
        name: str = ...,
        count: int | Param = ...,
        scale: float | Param = ...,
        scale_unit: Literal["voxel", "world"] | Param = ...,
        apart: float | Literal["auto"] | Param = ...,
        up: Sequence[float | Param] | Param = ...,
        animate: bool | Param = ...,
        length: float | Literal["auto"] | Param = ...,
        steady: int | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RigAdvect:
        """
        A rig that follows the flow. Each frame adds points around a seed, and the flow moves all points on. The rig
        runs from the seed through the centroid of each frame's points. Points that left the flow do not count.
        """
    def circle(
        self,
        center: Sequence[float | Param] | Param,
        radius: Sequence[float | Param] | float | Param,
        *,
        name: str = ...,
        normal: Sequence[float | Param] | Param = ...,
        start: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RigCircle:
        """
        A closed rig along a circle or an oval. The lattice's `u` points outwards, `v` along the normal.
        """
    def curve(
        self,
        path: str | Param,
        *,
        name: str = ...,
        closed: bool | Literal["auto"] | Param = ...,
        up: Sequence[float | Param] | Param = ...,
        axes: Literal["as_is", "y_to_z", "z_to_y"] | Param = ...,
        translate: Sequence[float | Param] | Param = ...,
        scale: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RigCurve:
        """
        A rig from a curve in a file, or one per frame from a sequence of files.
        """
    def points(
        self,
        *,
        name: str = ...,
        points: Sequence[Sequence[float | Param] | Param] | Param = ...,
        frames: Mapping[str, Any] | Param = ...,
        closed: bool | Param = ...,
        up: Sequence[float | Param] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RigPoints:
        """
        A rig through stated points, joined by straight lines; static or moving.
        """
    def python(
        self,
        script: str | Param,
        *,
        name: str = ...,
        inputs: Mapping[str, Source] = ...,
        params: Mapping[str, Any] | Param = ...,
        python: bool | float | str | Param = ...,
        timeout: float | Param = ...,
        animate: bool | Param = ...,
        closed: bool | Param = ...,
        up: Sequence[float | Param] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RigPython:
        """
        A rig through points that your own function in Python returns, `rig(..., at)`: an array (n, 3) in the world,
        in order.
        """
    def transform(
        self,
        rig: Source,
        *,
        name: str = ...,
        smooth: int | Param = ...,
        scale: float | Param = ...,
        pivot: Sequence[float | Param] | Param = ...,
        translate: Sequence[float | Param] | Param = ...,
        extend: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> RigTransform:
        """
        Smooths, scales, moves and extends a rig, in this order.
        """

class SdfFromMesh(Node):
    surface: Output

class SdfFromPoints(Node):
    surface: Output

class SdfToMesh(Node):
    mesh: Output

class SdfFamily:
    def from_mesh(
        self,
        mesh: Source,
        *,
        name: str = ...,
        like: Source = ...,
        voxel_size: float | Literal["auto"] | Param = ...,
        band: float | Param = ...,
        thickness: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SdfFromMesh:
        """
        Distances to the faces of a mesh, in a narrow band: a level set if the mesh is closed.
        """
    def from_points(
        self,
        points: Source,
        *,
        name: str = ...,
        like: Source = ...,
        voxel_size: float | Literal["auto"] | Param = ...,
        radius: float | Param = ...,
        smoothing: int | Param = ...,
        half_width: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SdfFromPoints:
        """
        The surface of particles: the distance to balls around them, as a level set.
        """
    def to_mesh(
        self,
        surface: Source,
        *,
        name: str = ...,
        isovalue: float | Param = ...,
        adaptivity: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SdfToMesh:
        """
        Makes a mesh of the surface on which a grid has a given value: that of a level set, or of a density.
        """

class SeamDynamic(Node):
    seams: Output

class SeamGraphCut(Node):
    seams: Output

class SeamGreedy(Node):
    seams: Output

class SeamPyramid(Node):
    seams: Output

class SeamPython(Node):
    seams: Output

class SeamFamily:
    def dynamic(
        self,
        energy: Source,
        lattice: Source,
        count: int | str | Param,
        *,
        name: str = ...,
        field: Source = ...,
        protect: Source = ...,
        attract: Source = ...,
        after: Source | Sequence[Source] = ...,
        axis: Literal["t", "u", "v", "w"] | Param = ...,
        window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        pair_window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        static: bool | Param = ...,
        pair_static: bool | Param = ...,
        best_effort: bool | Param = ...,
        measure: Literal["vertex", "volume"] | Param = ...,
        thickness: int | Literal["auto"] | Param = ...,
        cost: Literal["auto", "backward", "forward"] | Param = ...,
        field_weight: float | Param = ...,
        empty: float | Literal["auto"] | Param = ...,
        rigidity: float | Literal["auto"] | Param = ...,
        rigidity_time: float | Literal["auto"] | Param = ...,
        spread: int | Literal["auto"] | Param = ...,
        anchor: int | Literal["high", "low", "middle"] | Param = ...,
        bound_passes: int | Literal["auto"] | Param = ...,
        finest: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamDynamic:
        """
        Finds exact seams of least energy in images, by dynamic programming. For lattices one vertex thick, in one
        frame or with static seams.
        """
    def graph_cut(
        self,
        energy: Source,
        lattice: Source,
        count: int | str | Param,
        *,
        name: str = ...,
        field: Source = ...,
        protect: Source = ...,
        attract: Source = ...,
        after: Source | Sequence[Source] = ...,
        axis: Literal["t", "u", "v", "w"] | Param = ...,
        window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        pair_window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        static: bool | Param = ...,
        pair_static: bool | Param = ...,
        best_effort: bool | Param = ...,
        measure: Literal["vertex", "volume"] | Param = ...,
        thickness: int | Literal["auto"] | Param = ...,
        cost: Literal["auto", "backward", "forward"] | Param = ...,
        field_weight: float | Param = ...,
        empty: float | Literal["auto"] | Param = ...,
        rigidity: float | Literal["auto"] | Param = ...,
        rigidity_time: float | Literal["auto"] | Param = ...,
        spread: int | Literal["auto"] | Param = ...,
        anchor: int | Literal["high", "low", "middle"] | Param = ...,
        bound_passes: int | Literal["auto"] | Param = ...,
        finest: int | Literal["auto"] | Param = ...,
        keyframe_interval: int | Literal["auto"] | Param = ...,
        threshold: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamGraphCut:
        """
        Finds exact seams of least energy by a minimum cut through all vertices of all frames. Takes 40 bytes per
        vertex, 64 if steps cost something. Use it for small volumes, and to judge the other solvers.
        """
    def greedy(
        self,
        energy: Source,
        lattice: Source,
        count: int | str | Param,
        *,
        name: str = ...,
        field: Source = ...,
        protect: Source = ...,
        attract: Source = ...,
        after: Source | Sequence[Source] = ...,
        axis: Literal["t", "u", "v", "w"] | Param = ...,
        window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        pair_window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        static: bool | Param = ...,
        pair_static: bool | Param = ...,
        best_effort: bool | Param = ...,
        measure: Literal["vertex", "volume"] | Param = ...,
        thickness: int | Literal["auto"] | Param = ...,
        cost: Literal["auto", "backward", "forward"] | Param = ...,
        field_weight: float | Param = ...,
        empty: float | Literal["auto"] | Param = ...,
        rigidity: float | Literal["auto"] | Param = ...,
        rigidity_time: float | Literal["auto"] | Param = ...,
        spread: int | Literal["auto"] | Param = ...,
        anchor: int | Literal["high", "low", "middle"] | Param = ...,
        bound_passes: int | Literal["auto"] | Param = ...,
        finest: int | Literal["auto"] | Param = ...,
        starts: int | Param = ...,
        guide: Literal["cone", "gaussian"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamGreedy:
        """
        Finds seams by the paper's multi-greedy search: fast, typically 5 to 50 % above the least energy.
        """
    def pyramid(
        self,
        energy: Source,
        lattice: Source,
        count: int | str | Param,
        *,
        name: str = ...,
        field: Source = ...,
        protect: Source = ...,
        attract: Source = ...,
        after: Source | Sequence[Source] = ...,
        axis: Literal["t", "u", "v", "w"] | Param = ...,
        window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        pair_window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        static: bool | Param = ...,
        pair_static: bool | Param = ...,
        best_effort: bool | Param = ...,
        measure: Literal["vertex", "volume"] | Param = ...,
        thickness: int | Literal["auto"] | Param = ...,
        cost: Literal["auto", "backward", "forward"] | Param = ...,
        field_weight: float | Param = ...,
        empty: float | Literal["auto"] | Param = ...,
        rigidity: float | Literal["auto"] | Param = ...,
        rigidity_time: float | Literal["auto"] | Param = ...,
        spread: int | Literal["auto"] | Param = ...,
        anchor: int | Literal["high", "low", "middle"] | Param = ...,
        bound_passes: int | Literal["auto"] | Param = ...,
        finest: int | Literal["auto"] | Param = ...,
        quality: Literal["best", "draft", "normal"] | Param = ...,
        starts: int | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamPyramid:
        """
        Finds seams from coarse to fine, by messages in narrow strips. They are within half a percent of the least
        energy in real smoke and fire, and within one or two percent in rougher energies. They are exact in images and
        small volumes; thin ones are never worse than those of `seam.greedy`.
        """
    def python(
        self,
        energy: Source,
        lattice: Source,
        count: int | str | Param,
        script: str | Param,
        *,
        name: str = ...,
        field: Source = ...,
        protect: Source = ...,
        attract: Source = ...,
        after: Source | Sequence[Source] = ...,
        axis: Literal["t", "u", "v", "w"] | Param = ...,
        window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        pair_window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        static: bool | Param = ...,
        pair_static: bool | Param = ...,
        best_effort: bool | Param = ...,
        measure: Literal["vertex", "volume"] | Param = ...,
        thickness: int | Literal["auto"] | Param = ...,
        cost: Literal["auto", "backward", "forward"] | Param = ...,
        field_weight: float | Param = ...,
        empty: float | Literal["auto"] | Param = ...,
        rigidity: float | Literal["auto"] | Param = ...,
        rigidity_time: float | Literal["auto"] | Param = ...,
        spread: int | Literal["auto"] | Param = ...,
        anchor: int | Literal["high", "low", "middle"] | Param = ...,
        bound_passes: int | Literal["auto"] | Param = ...,
        finest: int | Literal["auto"] | Param = ...,
        params: Mapping[str, Any] | Param = ...,
        python: bool | float | str | Param = ...,
        timeout: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamPython:
        """
        Finds seams by your own function in Python, `seam(energy, at)`. It is called once for each seam, with what
        each entry costs, an array [t, k, j, entry]: inf is protected, below 0 attracted. It returns the seam's
        entries, whole numbers [t, k, j], which may differ by at most 1 between neighbours. With a `field`, and
        neither `static` nor `cost: backward`, a function `seam(energy, field, at)` also gets what is seen, [t, k, j,
        vertex]. Where seams are thick, an entry is the slab that begins there, so that `field` is longer. Of seams of
        frames (`axis: t`) arrays are [i, k, j, frame].
        """

class SeamsChoose(Node):
    chosen: Output

class SeamsCurves(Node):
    ...

class SeamsRead(Node):
    seams: Output

class SeamsWrite(Node):
    ...

class SeamsFamily:
    def choose(
        self,
        seams: Source,
        field: Source,
        lattice: Source,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamsChoose:
        """
        Keeps the first seams of a set, as many as look best together with a warp of what is left of the carve: all of
        them, some or none. How a carve looks is estimated by its similarity to the field, with even scaling in place
        of the warp. Slabs that are doubled are kept up to a third of the lattice's vertices: more repeats would stand
        side by side.
        """
    def curves(
        self,
        lattice: Source,
        seams: Source,
        path: str | Param,
        *,
        name: str = ...,
        every: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamsCurves:
        """
        Writes seams as curves, to view them beside the data: lines along each seam, at its place before the carve,
        one file per frame. PLY has a colour for each seam, on vertices and edges; OBJ has an object for each.
        Positions are those of the shot's world, with its axes.
        """
    def read(
        self,
        path: str | Param,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamsRead:
        """
        Reads seams or a warp from a file that seams.write wrote.
        """
    def write(
        self,
        seams: Source,
        path: str | Param,
        *,
        name: str = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> SeamsWrite:
        """
        Writes seams or a warp to one .vdb file. Any smaller number of the seams can be carved from it later.
        """

class TimeLoop(Node):
    volume: Output

class TimeLoopMesh(Node):
    mesh: Output

class TimeLoopPoints(Node):
    points: Output

class TimeRetime(Node):
    volume: Output

class TimeRetimeMesh(Node):
    mesh: Output

class TimeRetimePoints(Node):
    points: Output

class TimeFamily:
    def loop(
        self,
        source: Source,
        frames: Sequence[int | Param] | int | Param,
        *,
        name: str = ...,
        velocity: Source = ...,
        fade: int | Literal["auto"] | Param = ...,
        loops: int | Param = ...,
        start: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> TimeLoop:
        """
        A loop of a chosen length: of all parts of the sequence the one that closes best. Its last frames go over into
        those before its first, each place when both match best there. For points it stands for time.loop_points, for
        a mesh for time.loop_mesh.
        """
    def loop_mesh(
        self,
        source: Source,
        frames: Sequence[int | Param] | int | Param,
        *,
        name: str = ...,
        fade: int | Literal["auto"] | Param = ...,
        loops: int | Param = ...,
        start: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> TimeLoopMesh:
        """
        A loop of a mesh whose faces stay the same: time.loop for meshes. Ends are compared by where their vertices
        lie.
        """
    def loop_points(
        self,
        source: Source,
        frames: Sequence[int | Param] | int | Param,
        *,
        name: str = ...,
        fade: int | Literal["auto"] | Param = ...,
        loops: int | Param = ...,
        start: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> TimeLoopPoints:
        """
        A loop of particles: time.loop for points. Ends are compared by how many points lie where, and how they move.
        """
    def retime(
        self,
        source: Source,
        *,
        name: str = ...,
        velocity: Source = ...,
        speed: float | Literal["auto"] | Param = ...,
        frames: int | Literal["auto"] | Param = ...,
        curve: Sequence[Sequence[float | Param] | Param] | Param = ...,
        curve_file: str | Param = ...,
        start: int | Literal["auto"] | Param = ...,
        scale: float | Literal["auto"] | Param = ...,
        transport: Literal["mac_cormack", "semi_lagrangian"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> TimeRetime:
        """
        The same sequence, faster, slower, backwards, held, or along a curve. Frames between those of the source are
        moved there from both of their neighbours. What follows this node has the new frames. For points it stands for
        time.retime_points, for a mesh for time.retime_mesh.
        """
    def retime_mesh(
        self,
        source: Source,
        *,
        name: str = ...,
        speed: float | Literal["auto"] | Param = ...,
        frames: int | Literal["auto"] | Param = ...,
        curve: Sequence[Sequence[float | Param] | Param] | Param = ...,
        curve_file: str | Param = ...,
        start: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> TimeRetimeMesh:
        """
        The same mesh at another pace: time.retime for meshes. What follows this node has the new frames.
        """
    def retime_points(
        self,
        source: Source,
        *,
        name: str = ...,
        speed: float | Literal["auto"] | Param = ...,
        frames: int | Literal["auto"] | Param = ...,
        curve: Sequence[Sequence[float | Param] | Param] | Param = ...,
        curve_file: str | Param = ...,
        start: int | Literal["auto"] | Param = ...,
        scale: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> TimeRetimePoints:
        """
        The same particles at another pace: time.retime for points. What follows this node has the new frames.
        """

class UsdWrite(Node):
    ...

class UsdFamily:
    def write(
        self,
        path: str | Param,
        files: Mapping[str, Any] | Param,
        *,
        name: str = ...,
        volumes: Mapping[str, Source] = ...,
        fps: float | Param = ...,
        up: Literal["y", "z"] | Param = ...,
        meters_per_unit: float | Param = ...,
        translate: Sequence[float | Param] | Literal["auto"] | Param = ...,
        scale: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> UsdWrite:
        """
        Writes one .usda file that holds a shot together, for Solaris, usdview and Omniverse: volumes in .vdb files,
        meshes and points in .usda files. It names the files of all frames of the sequence, whichever of them a run
        delivers. The file appears whole or not at all.
        """

class VdbRead(Node):
    volume: Output

class VdbWrite(Node):
    ...

class VdbFamily:
    def read(
        self,
        path: str | Param,
        *,
        name: str = ...,
        grids: Mapping[str, Any] | Param = ...,
        missing: Literal["error", "hold", "skip"] | Param = ...,
        profile: Literal["auto", "bifrost", "blender", "embergen", "houdini", "none"] | Param = ...,
        translate: Sequence[float | Param] | Param = ...,
        scale: float | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> VdbRead:
        """
        Reads OpenVDB files: all grids of each frame, and chosen grids as outputs.
        """
    def write(
        self,
        source: Source,
        path: str | Param,
        *,
        name: str = ...,
        compression: Literal["as_read", "blosc", "none", "zip"] | Param = ...,
        half: Sequence[bool | float | str | Param] | Param = ...,
        full: Sequence[bool | float | str | Param] | Param = ...,
        translate: Sequence[float | Param] | Literal["auto"] | Param = ...,
        scale: float | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> VdbWrite:
        """
        Writes OpenVDB files: all grids of a volume, or one grid. A file appears whole or not at all.
        """

class WarpSolve(Node):
    seams: Output

class WarpFamily:
    def solve(
        self,
        energy: Source,
        lattice: Source,
        *,
        name: str = ...,
        field: Source = ...,
        protect: Source = ...,
        attract: Source = ...,
        after: Source | Sequence[Source] = ...,
        content: Source = ...,
        axis: Literal["t", "u", "v", "w"] | Param = ...,
        amount: Mapping[str, Any] | bool | float | str | Param = ...,
        amount_file: str | Param = ...,
        rest: bool | Param = ...,
        window: Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        pair_window: Sequence[Sequence[bool | float | str | Param] | Sequence[float | Param] | Param] | Sequence[bool | float | str | Param] | Sequence[float | Param] | Literal["auto"] | Param = ...,
        static: bool | Param = ...,
        anchor: int | Literal["high", "low", "middle"] | Param = ...,
        field_weight: float | Param = ...,
        evenness: float | Param = ...,
        empty: float | Param = ...,
        stiffness: float | Param = ...,
        stiffness_time: float | Param = ...,
        factor: int | Literal["auto"] | Param = ...,
        doc: str = ...,
        cache: bool = ...,
    ) -> WarpSolve:
        """
        Finds a displacement of all vertices as a whole, in place of seams: it squeezes or draws out most where that
        is seen least. The amount need not be whole, and may change along the lattice and over time.
        """

class Families:
    @property
    def energy(self) -> EnergyFamily: ...
    @property
    def field(self) -> FieldFamily: ...
    @property
    def filter(self) -> FilterFamily: ...
    @property
    def grid(self) -> GridFamily: ...
    @property
    def image(self) -> ImageFamily: ...
    @property
    def lattice(self) -> LatticeFamily: ...
    @property
    def mask(self) -> MaskFamily: ...
    @property
    def mesh(self) -> MeshFamily: ...
    @property
    def points(self) -> PointsFamily: ...
    @property
    def preview(self) -> PreviewFamily: ...
    @property
    def remap(self) -> RemapFamily: ...
    @property
    def rig(self) -> RigFamily: ...
    @property
    def sdf(self) -> SdfFamily: ...
    @property
    def seam(self) -> SeamFamily: ...
    @property
    def seams(self) -> SeamsFamily: ...
    @property
    def time(self) -> TimeFamily: ...
    @property
    def usd(self) -> UsdFamily: ...
    @property
    def vdb(self) -> VdbFamily: ...
    @property
    def warp(self) -> WarpFamily: ...
