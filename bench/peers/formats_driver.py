# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes files on demand with one of the peers: formats_driver.py meshio | trimesh | vtk.

Speaks as formats_driver.cpp does: a request per line in, the seconds and the counts out. What a peer delivers is what
its users get from the one call that its documentation shows: points and triangles, as NumPy arrays or VTK's own.
"""
import logging
import sys
import time


class Meshio:
    """Reading keeps the corners of an STL file merged, as ours; arrays have the file's type."""

    def __init__(self):
        import meshio

        self.library = meshio

    def read(self, path):
        return self.library.read(path)

    def write(self, path, held):
        self.library.write(path, held, binary=True)

    def sizes(self, held):
        return len(held.points), sum(len(cells.data) for cells in held.cells if cells.type == "triangle")


class Trimesh:
    """Reading leaves an STL file's corners as they are until process=True merges them, which is asked for there."""

    def __init__(self):
        import trimesh

        self.library = trimesh
        logging.disable(logging.CRITICAL)

    def read(self, path):
        held = self.library.load(path, process=path.endswith(".stl"))
        held.vertices  # made when first asked for
        return held

    def write(self, path, held):
        held.export(path)

    def sizes(self, held):
        return len(held.vertices), len(getattr(held, "faces", ()))


class Vtk:
    """vtkPolyData in single precision; the reader of STL files merges equal corners."""

    def __init__(self):
        import vtkmodules.vtkIOGeometry as geometry
        import vtkmodules.vtkIOPLY as ply

        self.readers = {"ply": ply.vtkPLYReader, "stl": geometry.vtkSTLReader}
        self.writers = {"ply": ply.vtkPLYWriter, "stl": geometry.vtkSTLWriter}

    def read(self, path):
        reader = self.readers[path[-3:]]()
        reader.SetFileName(path)
        reader.Update()
        return reader.GetOutput()

    def write(self, path, held):
        writer = self.writers[path[-3:]]()
        writer.SetFileTypeToBinary()
        writer.SetFileName(path)
        writer.SetInputData(held)
        if not writer.Write():
            raise RuntimeError("VTK could not write the file")

    def sizes(self, held):
        return held.GetNumberOfPoints(), held.GetNumberOfPolys()


def main():
    peer = {"meshio": Meshio, "trimesh": Trimesh, "vtk": Vtk}[sys.argv[1]]()
    held = None
    for line in sys.stdin:
        request, path = line.rstrip("\n").split(" ", 1)
        try:
            if request == "read":
                held = None
            begin = time.perf_counter()
            if request == "read":
                held = peer.read(path)
            else:
                peer.write(path, held)
            seconds = time.perf_counter() - begin
            print(f"{seconds:.6f}", *peer.sizes(held), flush=True)
        except BaseException as error:  # SystemExit too, which meshio raises; a peer's failure is an answer
            print("failed", type(error).__name__, str(error).replace("\n", " "), flush=True)


main()
