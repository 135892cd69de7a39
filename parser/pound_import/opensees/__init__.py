"""Read a model of OpenSees: its commands are recorded in a process of its own, then translated.

`replay` starts the process: `tcl_model` runs a Tcl file in a safe interpreter, `python_model` a Python file
with a module that stands in for OpenSees.  Both write `commands`.  `model` sorts these; `beams`, `links`,
`constraints`, `loading`, `motions`, `damping` and `stages` translate its parts, `materials` and `sections`
what they are made of.  `importer` calls them.
"""
