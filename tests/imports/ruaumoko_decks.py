"""Old decks written for the tests, with every item whose meaning is certain."""

HEADER = "2 0 1 0 2 0 0 0 0 0 0"

#: two storeys of springs, bilinear below, with a record behind
STICK = """Two storeys of springs
! a comment may stand anywhere
2 0 1 0 2 0 0 0 0 0 0
3 2 2 2 1 2 9.81 5.0 5.0 0.005 0.4 1.0   ! control
0 2 10 0 1 5 1 1 2 2 0 0
100 10 1e-08 0 0 0

NODES
1 0.0 0.0 1 1 1 0 0 0 0
2 3.0 0.0 0 1 1 0 0 0 0
3 6.0 0.0 0 1 1 2 0 0 0

DRIFT
1 3

ELEMENTS 0
1 1 1 2
2 2 2 3

PROPS
1 SPRING "lower storey"
1 2 0 0 6000 0 0 0.0 0.05 0.05
12 -10 0 0 0 0
2 SPRING
1 0 0 0 5.0D3 0 0 0 0 0

WEIGHTS 0
2 98.1 0 0
3 49.05 0 0

LOADS
1 0.0 0.0 0.0
3 0.5 0.0 0.0

EQUAKE
3 1 0.01 1 -1 0 0 1
START
0 0.0 0.9
1 0.01 0.0
2 0.02 0.3
3 0.05 -0.2

4 0.06 0.1
5 0.30 -0.1
"""

#: an oscillator with the rule 52, of the kind of the one deck with published results
OSCILLATOR = """Oscillator
2 0 1 0 2 0 0 0 0 0 0
2 1 1 1 1 2 9.81 5.0 5.0 0.001 0.05 1
0 10 10 0 1 5 1 1 1 2 0 0
100 10 1e-08 0 0 0
NODES
1 0.0 0.0 1 1 1 0 0 0 0
2 1.0 0.0 0 1 1 0 0 0 0
ELEMENTS 0
 1 1 1 2
PROPS
1 SPRING
1 52 0 0 4000 0 0 0.0 0.06 0.06
150 -150 0 0 0 0
1.0 0.06 0.8 0.7 0.6 0.5 3.5 3.0 0
0.4 0.0 0.3 0.31 0.0001 0
1.0 0.06 0.8 0.7 0.6 0.5 3.5 3.0 0
0.4 0.0 0.3 0.31 0.0001 0
1.0 0.06 0.8 0.7 0.6 0.5 3.5 3.0 0
0.4 0.0 0.3 0.31 0.0001 0
WEIGHTS 0
2 900 0 0
LOADS
1 0 0 0
2 0 0 0
EQUAKE
3 1 0.005 1 -1 0 0 1
START
0 0.0 0.1
1 0.005 0.2
2 0.010 0.3
"""

#: a portal: the order of a FRAME's items is recalled
PORTAL = """Portal
2 0 1 2 0 0 1 0 0 0 0
4 3 2 2 1 2 9.81 5.0 3.0 0.01 1.0 0.5
0 10 10 0 1 5 1 1 2 2 0 0
10 5 0.0001
NODES
1 0 0 1 1 1 0 0 0 0
2 0 3 0 0 0 0 0 0 0
3 5 3 2 0 0 2 0 0 0
4 5 0 1 1 1 0 0 0 0
DRIFT
1 2
ELEMENTS
1 1 1 2 0 0 0
2 2 2 3 0 0 0
3 1 4 3 0 0 0
PROPS
1 FRAME column
1 0 0 4 0 0 0 0 0
3.0E7 1.2E7 0.16 0 0.002 4.0 0 0.2
0 0.03 0.3 0.3
0 0 120 -120 120 -120
0.5 0 1 1
2 FRAME beam
1 0 2 0 0 0 0 0 0
3.0E7 0 0.2 0 0.005
30 -30
WEIGHTS
2 200 200 1
3 200 200 1
LOADS
2 0 -100 0
3 0 -100 0
EQUAKE
6 1 0.02 9.81 -1 0 0 1
"""

#: as those of the program in space: ten options, a line for the view
IN_SPACE = """Title
2 1 0 2 0 0 0 0 1 0
2 1 1 2 1 2 9.80 5.0 5.0 0.005 25.0 1.0
0 10 10 1.0 10 10 10 0 2 2 1 0
0 0 1 0 1 0
10 5 0.0001 0 0 0 0 0 0 0 0.10
NODES
1 0 0 0 1 1 1 1 1 1 0 0 0
2 0 3 0 0 0 0 0 0 0 0 0 0
"""
