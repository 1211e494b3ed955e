"""A picture drawn by VTK without a screen.

VTK's modules are taken one by one and its EGL window by name. Importing all of VTK or PyVista takes longer
than drawing, and a window of no stated kind looks for a screen first and complains on stderr.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import MissingLibraryError
from meshdrape.output.picture.camera import View

FloatArray = NDArray[np.float64]
Colour = Sequence[int]  # red, green, blue in 0..255, and opacity where it is not 255

_SAMPLES: Final = 8  # per pixel
_LIGHT_FROM: Final = (-0.4, 0.5, 1.0)  # right, up, towards the eye
_AMBIENT: Final = 0.7  # shading is gentle, so that colours can be compared with the legend
_DIFFUSE: Final = 0.32


class Stage:
    """Shapes in space and marks laid over them, drawn once.

    Positions in space are mm; on the picture they are pixels from its lower left corner. Marks cover one
    another in the order they are added, texts over all else.

    Parameters
    ----------
    width, height : int
        pixels
    view : View

    Raises
    ------
    MissingLibraryError
        The machine has no OpenGL that works without a screen.
    """

    def __init__(self, width: int, height: int, view: View) -> None:
        self._window = _window()
        from vtkmodules.vtkRenderingCore import vtkLight, vtkRenderer

        self._width, self._height = width, height
        self._view = view
        self._polygons: list[tuple[FloatArray, Colour]] = []
        self._texts: list[Any] = []
        light = vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*_LIGHT_FROM)
        self._renderer = vtkRenderer()
        self._renderer.SetBackground(1.0, 1.0, 1.0)
        self._renderer.AutomaticLightCreationOff()
        self._renderer.AddLight(light)
        self._window.SetMultiSamples(_SAMPLES)
        self._window.SetSize(width, height)
        self._window.AddRenderer(self._renderer)

    def add_faces(
        self,
        corners: FloatArray,
        normals: FloatArray,
        colours: ArrayLike,
        *,
        back: float = 0.0,
        cull: bool = False,
    ) -> None:
        """Add triangles or quads.

        Parameters
        ----------
        corners : (n, k, 3) float64, mm
        normals : (n, 3) or (n, k, 3) float64
            Unit normals of the faces or of their corners.
        colours : (n, 4) or (4,) uint8
        back : float
            mm away from the eye, which changes nothing but what hides what: the projection is parallel.
        cull : bool
            Leave out faces seen from behind.
        """
        n, k = corners.shape[:2]
        if not n:
            return
        each_corner = np.broadcast_to(normals if normals.ndim == 3 else normals[:, None], corners.shape)
        data = self._poly_data(corners.reshape(-1, 3), back)
        data.GetPointData().SetNormals(_vtk(each_corner.reshape(-1, 3).astype(np.float32)))
        data.SetPolys(_cells(np.full(n, k)))
        data.GetCellData().SetScalars(_vtk(np.broadcast_to(np.asarray(colours, dtype=np.uint8), (n, 4))))
        actor = self._actor(data)
        actor.GetProperty().SetAmbient(_AMBIENT)
        actor.GetProperty().SetDiffuse(_DIFFUSE)
        actor.GetProperty().SetBackfaceCulling(cull)

    def add_segments(self, ends: FloatArray, colour: Colour, width: float, *, back: float = 0.0) -> None:
        """Add straight lines (n, 2, 3), mm, of a width in pixels."""
        if not len(ends):
            return
        data = self._poly_data(ends.reshape(-1, 3), back)
        data.SetLines(_cells(np.full(len(ends), 2)))
        actor = self._actor(data)
        actor.GetProperty().SetColor(*(value / 255 for value in colour[:3]))
        actor.GetProperty().SetOpacity(colour[3] / 255 if len(colour) > 3 else 1.0)
        actor.GetProperty().SetLineWidth(width)
        actor.GetProperty().LightingOff()

    def add_polygon(self, points: ArrayLike, colour: Colour) -> None:
        """Lay a convex polygon (n, 2), pixels, over the picture."""
        self._polygons.append((np.asarray(points, dtype=np.float64), colour))

    def add_stroke(self, start: ArrayLike, end: ArrayLike, colour: Colour, width: float) -> None:
        """Lay a straight stroke from (x, y) to (x, y) over the picture; all in pixels."""
        a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
        along = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
        side = 0.5 * width * np.array([-along[1], along[0]])
        self.add_polygon([a + side, b + side, b - side, a - side], colour)

    def add_ring(self, centre: ArrayLike, radius: float, colour: Colour, width: float, *, broken: bool = False) -> None:
        """Lay a circle about (x, y) over the picture, whole or in eight arcs; all in pixels."""
        angle = np.linspace(0.0, 2.0 * np.pi, 65)
        rim = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        outer = np.asarray(centre) + (radius + 0.5 * width) * rim
        inner = np.asarray(centre) + max(radius - 0.5 * width, 0.0) * rim
        for k in (k for k in range(64) if not broken or k % 8 < 5):
            self.add_polygon([outer[k], outer[k + 1], inner[k + 1], inner[k]], colour)

    def add_text(
        self,
        text: str,
        at: ArrayLike,
        size: int,
        colour: Colour,
        *,
        align: Literal["left", "centre", "right"] = "left",
        bold: bool = False,
        plate: bool = False,
    ) -> None:
        """Write a line of text.

        Parameters
        ----------
        text : str
        at : (2,) float
            Where its middle height and its left end, centre or right end is, pixels.
        size : int
            Height of the letters, pixels.
        colour : sequence of int
        align : {"left", "centre", "right"}
        bold : bool
        plate : bool
            Put a white plate behind it, for a text on the drawing.
        """
        from vtkmodules.vtkRenderingCore import vtkTextActor

        actor = vtkTextActor()
        actor.SetInput(f" {text} " if plate else text)
        actor.SetPosition(*np.asarray(at, dtype=np.float64))
        style = actor.GetTextProperty()
        style.SetFontFamilyToArial()
        style.SetFontSize(size)
        style.SetBold(bold)
        style.SetColor(*(value / 255 for value in colour[:3]))
        style.SetVerticalJustificationToCentered()
        style.SetJustification(("left", "centre", "right").index(align))
        if plate:
            style.SetBackgroundColor(1.0, 1.0, 1.0)
            style.SetBackgroundOpacity(0.85)
        self._texts.append(actor)

    def png(self) -> bytes:
        """Return the picture as PNG."""
        from vtkmodules.vtkIOImage import vtkPNGWriter
        from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

        self._place_camera()
        if self._polygons:
            self._renderer.AddViewProp(self._overlay())
        for actor in self._texts:
            self._renderer.AddViewProp(actor)
        self._window.Render()
        image = vtkWindowToImageFilter()
        image.SetInput(self._window)
        image.ReadFrontBufferOff()
        image.ShouldRerenderOff()
        writer = vtkPNGWriter()
        writer.SetInputConnection(image.GetOutputPort())
        writer.SetCompressionLevel(4)
        writer.WriteToMemoryOn()
        writer.Write()
        return bytes(memoryview(writer.GetResult()))

    def _poly_data(self, points: FloatArray, back: float) -> Any:
        """Return points (n, 3), mm, moved away from the eye; as float, so told from the view's centre."""
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkPolyData

        shown = vtkPoints()
        shown.SetData(_vtk((points - self._view.centre - back * self._view.toward).astype(np.float32)))
        data = vtkPolyData()
        data.SetPoints(shown)
        return data

    def _actor(self, data: Any) -> Any:
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

        mapper = vtkPolyDataMapper()
        mapper.SetInputData(data)
        mapper.SetColorModeToDirectScalars()
        actor = vtkActor()
        actor.SetMapper(mapper)
        self._renderer.AddActor(actor)
        return actor

    def _overlay(self) -> Any:
        """Return the polygons as one actor: to set up an actor costs more than to draw it."""
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkPolyData
        from vtkmodules.vtkRenderingCore import vtkActor2D, vtkPolyDataMapper2D

        corners = np.concatenate([points for points, _ in self._polygons])
        shown = vtkPoints()
        shown.SetData(_vtk(np.column_stack([corners, np.zeros(len(corners))]).astype(np.float32)))
        data = vtkPolyData()
        data.SetPoints(shown)
        data.SetPolys(_cells([len(points) for points, _ in self._polygons]))
        colours = [(*colour[:3], colour[3] if len(colour) > 3 else 255) for _, colour in self._polygons]
        data.GetCellData().SetScalars(_vtk(np.array(colours, dtype=np.uint8)))
        mapper = vtkPolyDataMapper2D()
        mapper.SetInputData(data)
        mapper.SetColorModeToDirectScalars()
        actor = vtkActor2D()
        actor.SetMapper(mapper)
        return actor

    def _place_camera(self) -> None:
        view = self._view
        # the renderer shows its focal point in the middle of the window
        off = (np.array([self._width, self._height]) / 2 - view.middle) * view.mm_per_pixel
        focus = off @ view.axes[:2]
        camera = self._renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*focus)
        camera.SetPosition(*(focus + view.toward * view.mm_per_pixel * self._width))
        camera.SetViewUp(*view.axes[1])
        camera.SetParallelScale(0.5 * self._height * view.mm_per_pixel)
        self._renderer.ResetCameraClippingRange()


def _window() -> Any:
    """Return a window of VTK that draws in memory."""
    try:
        from vtkmodules import vtkRenderingFreeType, vtkRenderingOpenGL2
        from vtkmodules.vtkCommonCore import vtkLogger
        from vtkmodules.vtkRenderingCore import vtkRenderWindow
    except ImportError as error:
        from meshdrape.errors import missing_library

        raise missing_library(error) from None
    del vtkRenderingFreeType  # imported to register the renderer of texts
    # elsewhere than on Linux the platform's own window draws in memory too
    kind = getattr(vtkRenderingOpenGL2, "vtkEGLRenderWindow", vtkRenderWindow)
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    window = kind()
    window.SetOffScreenRendering(True)
    window.Initialize()
    vtkLogger.SetStderrVerbosity(verbosity)
    # asked here, as VTK goes on without OpenGL and ends in a segmentation fault
    if not window.GetInitialized():
        msg = "no OpenGL that draws without a screen; apt install libegl1 libgl1-mesa-dri"
        raise MissingLibraryError(msg)
    return window


def _cells(n_corners: ArrayLike) -> Any:
    """Return cells of the given numbers of corners (n,), which follow one another in the points."""
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    ends = np.cumsum(n_corners, dtype=np.int64)
    cells = vtkCellArray()
    cells.SetData(_vtk(np.concatenate([[0], ends])), _vtk(np.arange(ends[-1])))
    return cells


def _vtk(array: NDArray[Any]) -> Any:
    """Return an array as VTK's, with a copy of the values."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    return numpy_to_vtk(np.ascontiguousarray(array), deep=True)
