"""Small mesh files as their programs write them."""

ABAQUS_BAR = """*HEADING
two cubes of 10 mm, one of 20 nodes' worth of trouble
** a comment
*Node, nset=Nall
 1, 0., 0., 0.
 2, 10., 0., 0.
** another comment, within the data
 3, 10., 10., 0.
 4, 0., 10.
 15, 0., 0., 10.
 16, 10., 0., 10.
 17, 10., 10., 1.D1
 18, 0., 10., 10.
 25, 0., 0., 20.
 26, 10., 0., 20.
 27, 10., 10., 20.
 28, 0., 10., 20.
 99, 5., 5., 50.
*ELEMENT, TYPE=C3D8R, ELSET=lower
 7, 1, 2, 3, 4, 15, 16,
 17, 18
*element, type=C3D8I,
 elset=upper
 9, 15, 16, 17, 18, 25, 26, 27, 28
*ELEMENT, TYPE=S4, ELSET=skin
 12, 25, 26, 27, 28
*ELEMENT, TYPE=SPRINGA, ELSET=spring
 13, 99, 28
*NSET, NSET=foot
 1, 2, 3
*NSET, NSET="Foot"
 4,
*NSET, NSET=middle, GENERATE
 15, 18, 1
*NSET, NSET=ends
 FOOT, 25, 26
*NSET, NSET=of_upper, ELSET=UPPER
*NSET, NSET=reference
 99
*ELSET, ELSET=both
 lower, 9
*SURFACE, NAME=top, TYPE=ELEMENT
 upper, S2
*SURFACE, NAME=side
 7, S3
 upper, s3
*SURFACE, NAME=nodes, TYPE=NODE
 middle
*MATERIAL, NAME=Steel
*DENSITY
7.85E-9
*ELASTIC
 210000., 0.3, 0.
 200000., 0.3, 100.
*SOLID SECTION, ELSET=BOTH, MATERIAL=STEEL
*STEP
*STATIC
*NODE PRINT, NSET=Nall
U
*END STEP
"""

ABAQUS_ASSEMBLY = """*Heading
*Part, name=lever
*Node
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
4, 0., 0., 1.
*Element, type=C3D4
1, 1, 2, 3, 4
*Nset, nset=base
1, 2, 3
*Elset, elset=all
1,
*Solid Section, elset=all, material=steel
,
*End Part
*Assembly, name=whole
*Instance, name=lever-1, part=lever
*End Instance
*Instance, name=lever-2, part=lever
5., 0., 0.
5., 0., 0., 5., 0., 1., 90.
*End Instance
*Nset, nset=tip, instance=lever-2
4
*Nset, nset=feet, instance=lever-2
base
*Nset, nset=feet
lever-1.1
*End Assembly
*Material, name=steel
*Density
7850.
*Elastic
2.1e11, 0.3
"""

# Small, large and free fields, continuations with and without names, reals without an exponent's letter.
NASTRAN_BAR = """SOL 103
CEND
SET 5 = 1, 3 THRU 4,
        16
BEGIN BULK
$ two cubes of 10 mm
GRID           1              0.      0.      0.
GRID           2             10.      0.      0.
GRID*                  3                           1.0+1            10.0
*                    0.0
GRID,4,,0.,10.,0.
GRID          15              0.      0.     10.
GRID          16             10.      0.     10.
GRID          17             10.     10.     10.
GRID          18              0.     10.     10.
GRID          25              0.      0.    2.+1
GRID          26             10.      0.     20.
GRID          27             10.     10.     20.
GRID          28              0.     10.     20.
GRID          99              5.      5.     20.
CHEXA          7       1       1       2       3       4      15      16+A
+A            17      18
CHEXA,9,2,15,16,17,18,25,26,+
+,27,28
PSOLID         1       5
PSOLID,2,5
MAT1           5 210000.              .3 7.85-9
SPC1,11,123,1,THRU,4
SPC           12      25       3      0.      26       3      0.
RBE2          31      99  123456      25      26      27      28
RBE3,32,,99,123456,1.0,123,15,16,
,17,18
CELAS2,40,1.,1,1
ENDDATA
GRID        1000              0.      0.      0.
"""

GMSH_TETRAHEDRA = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "foot"
3 1 "body"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1 0 0
3 0 1 0
5 0 0 1
8 1 1 1
9 7 7 7
$EndNodes
$Elements
4
3 15 2 4 1 5
10 2 2 7 1 1 3 2
20 4 2 1 1 1 2 3 5
31 4 2 1 1 2 8 3 5
$EndElements
"""

GMSH_4 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "foot"
3 1 "body"
$EndPhysicalNames
$Entities
0 0 1 1
3 0 0 0 1 1 1 1 7 0
2 0 0 0 1 1 1 1 1 1 3
$EndEntities
$Nodes
1 5 1 8
3 2 0 5
1
2
3
5
8
0 0 0
1 0 0
0 1 0
0 0 1
1 1 1
$EndNodes
$Elements
2 3 10 31
2 3 2 1
10 1 3 2
3 2 4 2
20 1 2 3 5
31 2 8 3 5
$EndElements
"""
