"""Names of the commands of OpenSees: what a replay records, answers, or leaves without effect."""

from __future__ import annotations

from typing import Final


def _words(text: str) -> tuple[str, ...]:
    return tuple(text.split())


#: commands that a translation reads
READ: Final = _words(
    """
    wipe model node fix fixX fixY mass equalDOF rigidLink uniaxialMaterial section patch layer fiber
    geomTransf beamIntegration element timeSeries pattern load eleLoad sp groundMotion imposedMotion
    rayleigh modalDamping region eigen analysis integrator analyze loadConst setTime wipeAnalysis reset
    recorder setNodeDisp setNodeVel remove updateElementDomain
    """
)
#: commands that no plane frame of this program has; a translation refuses them
REFUSED: Final = _words(
    """
    nDMaterial block2D block3D rigidDiaphragm frictionModel limitCurve imposedSupport equalDOF_Mixed
    ShallowFoundationGen
    damping modalDampingQ updateParameter setParameter
    setElementRayleighDampingFactors hystereticBackbone mesh setNodeAccel setNodeCoord fixZ setStrain
    partition remesh updateMaterialStage loadElementRate fireLoad yieldSurface_BC
    """
)
#: commands of analyses of reliability and sensitivity, which a translation leaves out
LEFT_OUT: Final = _words(
    """
    reliability wipeReliability randomVariable correlate parameter addToParameter performanceFunction
    gradPerformanceFunction gradientEvaluator functionEvaluator sensitivityIntegrator
    probabilityTransformation randomNumberGenerator reliabilityConvergenceCheck searchDirection
    meritFunctionCheck stepSizeRule rootFinding startPoint findDesignPoint runFORMAnalysis runFOSMAnalysis
    runSORMAnalysis runImportanceSamplingAnalysis getPDF getCDF getInverseCDF
    """
)
#: commands that control the solution or write results
SILENT: Final = _words(
    """
    system numberer constraints test algorithm initialize print printModel printA printB printGID
    database save restore
    logFile record remove_recorders barrier start stop setPrecision display prp vrp vup vpn viewWindow plane
    port projection fill domainChange reactions InitialStateAnalysis computeGradients defaultUnits
    sensitivityAlgorithm invoke setCreep numFact playback
    """
)
#: commands that ask for a number of the solution: zero
COUNTS: Final = _words(
    """
    testIter testNorm testNorms accelCPU totalCPU solveCPU numIter getLoadFactor nodePressure systemSize
    classType getEleClassTags strain stress testUniaxialMaterial setTangent tangent getPID getNP
    getParamValue getParamTags version getNumThreads
    """
)
#: commands that ask for results: zero of one direction, or as many as all
RESULTS: Final = _words(
    """
    nodeVel nodeAccel nodeReaction nodeUnbalance nodeResponse eleForce eleResponse eleDynamicalForce
    basicForce basicDeformation basicStiffness localForce sectionForce sectionDeformation sectionLocation
    sectionWeight sectionStiffness sectionFlexibility
    """
)
#: commands that the replay answers from the model itself
ASKED: Final = _words(
    """
    getTime nodeCoord nodeDisp nodeMass getNodeTags getEleTags eleNodes nodeEigenvector getNDM getNDF
    nodeBounds modalProperties
    """
)
EVERY: Final = (*READ, *LEFT_OUT, *REFUSED, *SILENT, *COUNTS, *RESULTS, *ASKED)
