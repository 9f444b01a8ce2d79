"""Reads a surface with VTK and prints what it holds, a line each; exit code 77 where VTK is not installed."""
import sys

try:
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    sys.exit(77)

reader = vtkXMLPolyDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
mesh = reader.GetOutput()
print("points", mesh.GetNumberOfPoints())
print("triangles", mesh.GetNumberOfPolys())

seams = vtkFeatureEdges()
seams.SetInputData(mesh)
seams.BoundaryEdgesOn()
seams.NonManifoldEdgesOn()
seams.FeatureEdgesOff()
seams.ManifoldEdgesOff()
seams.Update()
print("open or non-manifold edges", seams.GetOutput().GetNumberOfLines())

for kind, data in (("point", mesh.GetPointData()), ("cell", mesh.GetCellData()), ("field", mesh.GetFieldData())):
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        last = array.GetTuple(array.GetNumberOfTuples() - 1)
        print(kind, array.GetName(), array.GetNumberOfTuples(), *(f"{x:.7g}" for x in last))
