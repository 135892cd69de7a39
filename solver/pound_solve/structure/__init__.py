"""The assembled structure: degrees of freedom, elements, damping, geometry, reduction."""
