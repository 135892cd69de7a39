"""Models of OpenSees, written for the tests."""

#: two storeys of elastic members with loads, damping and a motion; units kN, m, s
FRAME = """\
# two storeys, one bay
wipe
model BasicBuilder -ndm 2 -ndf 3
set h 3.5
for {set k 0} {$k < 3} {incr k} {
    node [expr {10*$k + 1}] 0.0 [expr {$k*$h}]
    node [expr {10*$k + 2}] 6.0 [expr {$k*$h}]
}
fix 1 1 1 1
fix 2 1 1 1
geomTransf PDelta 1
geomTransf Linear 2
proc column {tag i j} {
    element elasticBeamColumn $tag $i $j 0.09 2.5e7 6.75e-4 1
}
column 1 1 11
column 2 2 12
column 3 11 21
column 4 12 22
element elasticBeamColumn 5 11 12 0.12 2.5e7 1.6e-3 2
element elasticBeamColumn 6 21 22 0.12 2.5e7 1.6e-3 2
foreach n {11 12} { mass $n 16.0 16.0 0.0 }
mass 21 14.0 14.0 0.0
mass 22 14.0 14.0 0.0
timeSeries Linear 1
pattern Plain 1 1 {
    load 11 0.0 -98.1 0.0
    load 12 0.0 -98.1 0.0
    eleLoad -ele 5 6 -type -beamUniform -20.0
}
set lambda [eigen 2]
set w1 [expr {sqrt([lindex $lambda 0])}]
set w2 [expr {sqrt([lindex $lambda 1])}]
set xi 0.05
rayleigh [expr {2*$xi*$w1*$w2/($w1 + $w2)}] 0.0 [expr {2*$xi/($w1 + $w2)}] 0.0
recorder Drift -file out/drift.txt -iNode 1 11 -jNode 11 21 -dof 1 -perpDirn 2
constraints Transformation
system BandGeneral
test NormDispIncr 1e-10 20
algorithm Newton
integrator LoadControl 0.1
analysis Static
analyze 10
loadConst -time 0.0
timeSeries Trig 2 0.0 5.0 0.6 -factor 2.0
pattern UniformExcitation 2 1 -accel 2
wipeAnalysis
integrator Newmark 0.5 0.25
analysis Transient
set ok 0
while {$ok == 0 && [getTime] < 5.0} {
    set ok [analyze 1 0.01]
}
puts "the roof went to [nodeDisp 21 1]"
"""
#: two masses on springs that yield, with a gap between them
POUNDING = """\
model basic -ndm 2 -ndf 3
node 1 0 0
node 2 0 0
node 3 1 0
node 4 1 0
foreach n {1 3} { fix $n 1 1 1 }
foreach n {2 4} { fix $n 0 1 1 }
mass 2 1.0 1.0 0.0
mass 4 2.0 2.0 0.0
uniaxialMaterial Steel01 1 4.0 100.0 0.05
uniaxialMaterial Elastic 2 500.0
uniaxialMaterial ElasticPPGap 3 1e5 -1e9 -0.02
element zeroLength 1 1 2 -mat 1 -dir 1 -doRayleigh 1
element zeroLength 2 3 4 -mat 2 -dir 1 -doRayleigh 1
element twoNodeLink 3 2 4 -mat 3 -dir 1
region 1 -ele 1 -rayleigh 0.2 0.0 0.001 0.0
region 2 -ele 2 -rayleigh 0.1 0.0 0.0 0.0
timeSeries Path 1 -dt 0.1 -values {0.0 3.0 -3.0 2.0 -2.0 1.0 0.0} -factor 1.5
pattern UniformExcitation 1 1 -accel 1
analysis Transient
analyze 300 0.01
"""
#: a cantilever of a fibre section under its weight, pushed
FIBRES = """\
model basic -ndm 2 -ndf 3
node 1 0 0
node 2 0 3.0
fix 1 1 1 1
mass 2 20.0 20.0 0.0
uniaxialMaterial Concrete01 1 -30e3 -0.002 -25e3 -0.01
uniaxialMaterial Steel01 2 420e3 2.0e8 0.01
section Fiber 1 {
    patch rect 1 20 1 -0.2 -0.2 0.2 0.2
    layer straight 2 3 5e-4 0.15 -0.15 0.15 0.15
    layer straight 2 3 5e-4 -0.15 -0.15 -0.15 0.15
}
geomTransf Linear 1
element nonlinearBeamColumn 1 1 2 5 1 1
pattern Plain 1 Linear { load 2 0.0 -600.0 0.0 }
integrator LoadControl 1.0
analysis Static
analyze 1
loadConst -time 0.0
pattern Plain 2 Linear { load 2 1.0 0.0 0.0 }
integrator DisplacementControl 2 1 0.001
analyze 60
"""
#: two storeys of elastic members in Python
IN_PYTHON = """\
import openseespy.opensees as ops
import opsvis
ops.wipe()
ops.model('basic', '-ndm', 2, '-ndf', 3)
for i in range(3):
    ops.node(i + 1, 0.0, 3.0 * i)
ops.fix(1, *[1, 1, 1])
ops.geomTransf('Linear', 1)
for i in range(2):
    ops.element('elasticBeamColumn', i + 1, i + 1, i + 2, 0.1, 2e7, 1e-3, 1)
    ops.mass(i + 2, 10.0, 10.0, 0.0)
w = [x ** 0.5 for x in ops.eigen(2)]
ops.rayleigh(0.1 * w[0] * w[1] / (w[0] + w[1]), 0.0, 0.1 / (w[0] + w[1]), 0.0)
opsvis.plot_model()
print('not a command')
"""
#: two storeys, two bays, beams and bases with hinges of zero length; each floor moves along x as one
HINGED = """\
# the hinges stand at joints that follow the first joint of their floor
model BasicBuilder -ndm 2 -ndf 3
for {set k 0} {$k < 3} {incr k} {
    for {set i 1} {$i < 4} {incr i} {
        node [expr {10*$k + $i}] [expr {6.0*($i - 1)}] [expr {3.5*$k}]
    }
}
geomTransf Linear 1
uniaxialMaterial Steel01 1 250.0 6.0e4 0.02
proc hinge {tag joint inside x y} {
    node $inside $x $y
    equalDOF $joint $inside 1 2
    element zeroLength $tag $joint $inside -mat 1 -dir 6
}
foreach {k i} {0 1 0 2 0 3} {
    fix $i 1 1 1
    hinge [expr {200 + $i}] $i [expr {100 + $i}] [expr {6.0*($i - 1)}] 0.0
    element elasticBeamColumn $i [expr {100 + $i}] [expr {10 + $i}] 0.01 2.0e8 1.2e-4 1
    element elasticBeamColumn [expr {10 + $i}] [expr {10 + $i}] [expr {20 + $i}] 0.01 2.0e8 1.0e-4 1
}
foreach k {1 2} {
    foreach i {1 2} {
        set joint [expr {10*$k + $i}]
        set left [expr {1000 + $joint}]
        set right [expr {2000 + $joint}]
        hinge [expr {300 + $joint}] $joint $left [expr {6.0*($i - 1)}] [expr {3.5*$k}]
        hinge [expr {400 + $joint}] [expr {$joint + 1}] $right [expr {6.0*$i}] [expr {3.5*$k}]
        element elasticBeamColumn [expr {500 + $joint}] $left $right 0.008 2.0e8 1.5e-4 1
    }
    equalDOF [expr {10*$k + 1}] [expr {10*$k + 2}] 1
    equalDOF [expr {10*$k + 2}] [expr {10*$k + 3}] 1
    mass [expr {10*$k + 1}] 20.0 1.0 0.0
    mass [expr {10*$k + 2}] 20.0 1.0 0.0
    mass [expr {10*$k + 3}] 15.0 1.0 0.0
}
pattern Plain 1 Linear {
    load 13 30.0 0.0 0.0
    load 1021 0.0 -100.0 0.0
    load 23 40.0 -50.0 10.0
}
eigen 3
integrator LoadControl 1.0
analysis Static
analyze 1
"""
#: a truss without rotations, one node of which follows a lower one
TRUSS = """\
model BasicBuilder -ndm 2 -ndf 2
foreach {n x y} {1 0 0  2 4 0  3 0 3  4 4 3  5 4 4} { node $n $x $y }
fix 1 1 1
fix 2 1 1
uniaxialMaterial Elastic 1 2e8
foreach {e i j} {1 1 3  2 1 4  3 3 4  4 2 4  5 2 5  6 3 5} { element truss $e $i $j 0.01 1 }
equalDOF 3 5 1
mass 3 10 10
mass 5 10 10
pattern Plain 1 Linear { load 5 10 -5 }
eigen 2
integrator LoadControl 1.0
analysis Static
analyze 1
"""
