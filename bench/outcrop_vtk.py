#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""VTK's quadric decimation with texture coordinates in the cost, beside ours (Debian: python3-vtk9).

    outcrop_vtk.py MESH.obj FOLDER PERCENT...    writes FOLDER/vtk_PERCENT.obj, simplified by so much, one material

    bench_outcrop error MESH.obj FOLDER
"""
import os
import resource
import sys

from vtkmodules.vtkFiltersCore import vtkQuadricDecimation, vtkTriangleFilter
from vtkmodules.vtkIOGeometry import vtkOBJReader


def first_line(path, word):
    with open(path, errors="replace") as lines:
        return next((line.strip() for line in lines if line.startswith(word)), None)


def write(mesh, path, library, material):
    points, uvs = mesh.GetPoints(), mesh.GetPointData().GetTCoords()
    with open(path, "w") as out:
        out.write(f"{library}\n{material}\n")
        for i in range(mesh.GetNumberOfPoints()):
            out.write("v %.9g %.9g %.9g\n" % points.GetPoint(i))
            out.write("vt %.9g %.9g\n" % uvs.GetTuple2(i))
        for i in range(mesh.GetNumberOfCells()):
            cell = mesh.GetCell(i)
            out.write("f " + " ".join("{0}/{0}".format(cell.GetPointId(k) + 1) for k in range(3)) + "\n")


def main():
    source, folder, percents = sys.argv[1], sys.argv[2], [int(word) for word in sys.argv[3:]]
    reader = vtkOBJReader()
    reader.SetFileName(source)
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    library = first_line(source, "mtllib").split(None, 1)[1]
    library = "mtllib " + os.path.relpath(os.path.join(os.path.dirname(source), library), folder)
    material = first_line(source, "usemtl")
    for percent in percents:
        decimation = vtkQuadricDecimation()
        decimation.SetInputConnection(triangles.GetOutputPort())
        decimation.SetTargetReduction(percent / 100)
        decimation.AttributeErrorMetricOn()
        decimation.ScalarsAttributeOff()
        decimation.VectorsAttributeOff()
        decimation.NormalsAttributeOff()
        decimation.TensorsAttributeOff()
        decimation.TCoordsAttributeOn()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        decimation.Update()
        seconds = resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
        print(f'{{"simplified_percent": {percent}, "triangles": {decimation.GetOutput().GetNumberOfCells()}, '
              f'"processor_seconds": {seconds:.2f}}}', flush=True)
        write(decimation.GetOutput(), os.path.join(folder, f"vtk_{percent}.obj"), library, material)


if __name__ == "__main__":
    main()
