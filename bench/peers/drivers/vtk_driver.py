# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK: reads and writes files, repair, subdivision, decimation. vtkPolyData is in single precision. The STL reader merges equal corners."""
import os

import numpy
import vtkmodules.vtkIOGeometry as geometry
import vtkmodules.vtkIOPLY as ply
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkPolyDataNormals, vtkQuadricDecimation
from vtkmodules.vtkFiltersModeling import vtkButterflySubdivisionFilter, vtkFillHolesFilter

from answer import answer, of_decimation, of_filling, of_repair, read_points, read_triangles, timed

readers = {"ply": ply.vtkPLYReader, "stl": geometry.vtkSTLReader}
writers = {"ply": ply.vtkPLYWriter, "stl": geometry.vtkSTLWriter}
held = {}


def load(request):
    points, triangles = read_points(request["path"]).astype("float32"), read_triangles(request["path"])
    held["mesh"] = vtkPolyData()
    vertices, cells = vtkPoints(), vtkCellArray()
    vertices.SetData(numpy_to_vtk(points, deep=True))
    starts = numpy.arange(0, 3 * len(triangles) + 1, 3, dtype=numpy.int64)
    cells.SetData(
        numpy_to_vtk(starts, deep=True), numpy_to_vtk(triangles.astype(numpy.int64).reshape(-1), deep=True)
    )
    held["mesh"].SetPoints(vertices)
    held["mesh"].SetPolys(cells)
    return {"points": len(points), "triangles": len(triangles)}


def read(request):
    held["file"] = None
    reader = readers[request["path"][-3:]]()
    reader.SetFileName(request["path"])
    seconds, _ = timed(reader.Update)
    held["file"] = reader.GetOutput()
    counts = {"points": held["file"].GetNumberOfPoints(), "triangles": held["file"].GetNumberOfPolys()}
    return {"seconds": seconds, **counts}


def write(request):
    writer = writers[request["path"][-3:]]()
    writer.SetFileTypeToBinary()
    writer.SetFileName(request["path"])
    writer.SetInputData(held["file"])
    seconds, done = timed(writer.Write)
    if not done:
        raise RuntimeError("VTK could not write the file")
    return {"seconds": seconds, "bytes": os.path.getsize(request["path"])}


def decimate(request):
    filter = vtkQuadricDecimation()
    filter.SetInputData(held["mesh"])
    filter.SetTargetReduction(1 - request["triangles"] / held["mesh"].GetNumberOfPolys())
    seconds, _ = timed(filter.Update)
    return of_decimation(request, seconds, *arrays(filter.GetOutput()))


def arrays(made):
    points, triangles = made.GetPoints().GetData(), made.GetPolys().GetConnectivityArray()
    return vtk_to_numpy(points), vtk_to_numpy(triangles).reshape(-1, 3)


def fill_holes(request):
    """Closes every loop with triangles between its vertices. Its limit is the radius of a sphere round the hole."""
    filter = vtkFillHolesFilter()
    filter.SetInputData(held["mesh"])
    filter.SetHoleSize(1e30)
    seconds, _ = timed(filter.Update)
    return of_filling(seconds, *arrays(filter.GetOutput()))


def repair(request):
    """Joins equal points, then orients neighbours equally."""
    joined, oriented = vtkCleanPolyData(), vtkPolyDataNormals()
    joined.SetInputData(held["mesh"])
    joined.ToleranceIsAbsoluteOn()
    joined.SetAbsoluteTolerance(0)
    oriented.SetInputConnection(joined.GetOutputPort())
    oriented.ConsistencyOn()
    oriented.SplittingOff()
    seconds, _ = timed(oriented.Update)
    return of_repair(seconds, *arrays(oriented.GetOutput()))


def subdivide(request):
    """Butterfly: the vertices of the mesh stay."""
    filter = vtkButterflySubdivisionFilter()
    filter.SetInputData(held["mesh"])
    filter.SetNumberOfSubdivisions(request["segments"].bit_length() - 1)
    seconds, _ = timed(filter.Update)
    return {"seconds": seconds, "triangles": filter.GetOutput().GetNumberOfPolys()}


def render(request):
    """A parallel view from above, with the margins of Scanmill's: 5 % beside the box of the points."""
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401, chooses the classes that draw

    width, height = request["width"], request["height"]

    def work():
        smooth = vtkPolyDataNormals()
        smooth.SetInputData(held["mesh"])
        smooth.SplittingOff()
        mapper, actor, renderer, window = vtkPolyDataMapper(), vtkActor(), vtkRenderer(), vtkRenderWindow()
        mapper.SetInputConnection(smooth.GetOutputPort())
        actor.SetMapper(mapper)
        renderer.AddActor(actor)
        renderer.SetBackground(1, 1, 1)
        window.SetOffScreenRendering(True)
        window.SetMultiSamples(0)
        window.SetSize(width, height)
        window.AddRenderer(renderer)
        x0, x1, y0, y1, z0, z1 = held["mesh"].GetBounds()
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint((x0 + x1) / 2, (y0 + y1) / 2, z0)
        camera.SetPosition((x0 + x1) / 2, (y0 + y1) / 2, z1 + (z1 - z0))
        camera.SetViewUp(0, 1, 0)
        camera.SetParallelScale(max((x1 - x0) * height / width, y1 - y0) / 0.9 / 2)
        renderer.ResetCameraClippingRange()
        window.Render()
        image = vtkWindowToImageFilter()
        image.SetInput(window)
        image.Update()
        return vtk_to_numpy(image.GetOutput().GetPointData().GetScalars()).copy()

    seconds, pixels = timed(work)
    return {"seconds": seconds, "covered": float((pixels != 255).any(axis=1).mean())}


answer(
    {"load": load, "read": read, "write": write, "fill-holes": fill_holes, "repair": repair, "subdivide": subdivide,
     "decimate": decimate, "render": render},
    {"VTK": vtkVersion.GetVTKVersion()},
)
