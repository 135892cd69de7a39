"""All messages: the number of each, its title, its meaning and cure; the manual's page is written from it.

Numbers: P1xx source text, P2xx cards and values, P3xx the model, R4xx records, A5xx stops of an analysis,
S6xx studies of many runs, L6xx decks of Ruaumoko.  A number stands for its message for good.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

MESSAGES: Final[Mapping[str, tuple[str, str]]] = {
    "P101": (
        "not UTF-8 (warning)",
        "The file contains bytes that are not UTF-8 and is read as Latin-1. Save it as UTF-8.",
    ),
    "P102": (
        "not a text file",
        "The file contains NUL bytes, as in programs, pictures and UTF-16 text. Save it as UTF-8 text.",
    ),
    "P103": (
        "a web page",
        "The file starts like an HTML or XML page: the download saved a page, not the deck. Download the "
        "raw file.",
    ),
    "P104": (
        "deck too large",
        "The deck and its included files exceed 8 MB. Move records into separate files and name them "
        "under EQUAKE.",
    ),
    "P105": (
        "INCLUDE file not readable",
        "The included file is missing or cannot be read. Its name is relative to the folder of the file "
        "that includes it.",
    ),
    "P106": ("INCLUDE loop", "A file includes itself, directly or through others. Remove one INCLUDE."),
    "P107": (
        "too many INCLUDEs",
        "INCLUDEs are nested more than 20 deep, or number more than 1000. Merge some files.",
    ),
    "P108": ("INCLUDE without a file name", "INCLUDE needs one file name in quotes and nothing else."),
    "P109": ("nothing after &", "A line ends in &, but no continuation line follows. Remove the &."),
    "P110": (
        "line too long",
        "A line with its continuations exceeds 2 000 000 characters. Split it into several cards, or "
        "use a range.",
    ),
    "P201": (
        "invalid character",
        "The character has no meaning outside quotes. Minus signs and quotes pasted from a text "
        "processor are the usual cause.",
    ),
    "P202": ("quote not closed", "A text starts with a quote that is not closed on the same line."),
    "P203": ("brackets do not match", "A bracket has no partner on the same card."),
    "P204": ("brackets too deep", "Brackets are nested more than 50 deep. Use PARAM for the parts."),
    "P205": (
        "blank inside an expression",
        "Blanks separate items. Write 1-2 or (1 - 2) for a difference, and 1 -2 for two items.",
    ),
    "P206": ("blank inside a list", "Comma lists have no blanks: write 1,3,5 or 1,4 TO 8."),
    "P207": (
        "neither number nor word",
        "A word starts with a letter; a number is followed by a blank, a comma or an operator.",
    ),
    "P208": (
        "range not understood",
        "A range is written first TO last, or first TO last BY step. TO and BY cannot be names.",
    ),
    "P209": (
        "not understood",
        "Unexpected item on this card. An item is a number, an expression, a word, a text, a "
        "list or NAME=value.",
    ),
    "P210": ("unknown word", "The word is not among the choices for this item. The message lists them."),
    "P211": ("unknown item name", "The card has no item of that name. The message lists its items."),
    "P212": ("item given twice", "A card gives one item twice, by name or by position. Remove one."),
    "P213": (
        "item missing",
        "The card needs an item that has no default. The message gives its meaning and unit.",
    ),
    "P214": (
        "too many items",
        "The card has more items by position than it allows. Write further items as NAME=value, "
        "and lists with commas.",
    ),
    "P215": (
        "item after a named one",
        "Positional items come before named ones. Join the values of one item by commas without blanks: "
        "NODES=100,100+n.",
    ),
    "P216": (
        "wrong kind of value",
        "The item needs another kind of value: a number, a whole number, a text or a word. A text must "
        "be in quotes unless it is one word or one number.",
    ),
    "P217": (
        "value out of limits",
        "The number is outside the limits of this item, which the message gives. To keep results finite, "
        "magnitudes are at most 1e30, and items that must be above 0 are at least 1e-30.",
    ),
    "P218": (
        "wrong number of values",
        "The item needs another number of values, joined by commas without blanks.",
    ),
    "P219": (
        "range not allowed",
        "The item allows no range, or the card's first item is not a range. Ranges generate nodes and "
        "elements, and are allowed in lists of nodes and elements.",
    ),
    "P220": (
        "range does not fit",
        "The range descends, misses its end, or cannot be stepped evenly along with the card's first "
        "range. a TO b with b = a - 1 is valid and empty: it adds nothing to a list of nodes or "
        "elements, a card with an empty list applies to nothing, and a NODES or ELEMENTS line that "
        "starts with it generates nothing. A lower b is an error.",
    ),
    "P221": (
        "too much generated",
        "The deck's ranges generate more than 100 000 numbers. Check their ends.",
    ),
    "P222": (
        "unknown name",
        "The deck defines no PARAM of that name. Define it with PARAM, or put a text in quotes.",
    ),
    "P223": ("division by zero", "The expression divides by zero or raises zero to a negative power."),
    "P224": ("number too large", "The number or the value of the expression is beyond 1.8e308."),
    "P225": (
        "no real value",
        "The function or power has no real value here, such as the root of a negative number.",
    ),
    "P226": (
        "unknown function",
        "The function is unknown or needs another number of arguments. The message lists the functions.",
    ),
    "P227": ("text in arithmetic", "A text cannot be added, multiplied or given to a function."),
    "P228": ("circular PARAM", "The value of a PARAM depends on itself. Set one name to a number."),
    "P229": (
        "PARAM given twice",
        "A PARAM has two values in the deck. Remove one, or override it with --set.",
    ),
    "P230": ("PARAM name reserved", "Names of functions, PI, TO, BY, NAN and INF cannot be PARAM names."),
    "P231": (
        "PARAM not understood",
        "Write PARAM name = value, one value each; one line can define several.",
    ),
    "P232": (
        "--set of an unknown PARAM",
        "Only names that the deck defines with PARAM can be set from the command line.",
    ),
    "P233": (
        "--set value not understood",
        "Set a numeric PARAM to a number or an expression, and a text PARAM to any text, with or without "
        "quotes.",
    ),
    "P234": (
        "line outside any section",
        "The line comes before the first section. Write the section's name (NODES, ELEMENTS, ...) "
        "on a line above it.",
    ),
    "P235": (
        "unknown section",
        "The word alone on its line is neither a section of a deck nor a line of the section above.",
    ),
    "P236": (
        "words after a section's name",
        "A section's name must be alone on its line. Put column heads after an exclamation mark.",
    ),
    "P237": (
        "card given twice",
        "TITLE, UNITS, GRAVITY, MASS, GEOMETRY and MEANT are allowed once in a deck.",
    ),
    "P238": ("UNITS not understood", "Write UNITS force length time, for example UNITS kN m s."),
    "P239": (
        "file name without quotes",
        "The item is neither a word nor an expression. If it names a file, put it in quotes: FILE="
        '"records/a-1.at2".',
    ),
    "P301": ("node given twice", "Two cards define the same node number. Ranges generate numbers too."),
    "P302": (
        "element given twice",
        "Two cards define the same element number. Ranges generate numbers too.",
    ),
    "P303": ("property set given twice", "Two lines under PROPS have the same label; case is ignored."),
    "P304": ("drift given twice", "Two lines under DRIFT have the same name."),
    "P305": (
        "unknown node",
        "The node is not defined under NODES. To connect an element to the ground, omit J.",
    ),
    "P306": ("unknown element", "The element is not defined under ELEMENTS."),
    "P307": ("unknown property set", "The label is not defined under PROPS."),
    "P308": (
        "SLAVED and MASTER go together",
        "A node with SLAVED needs a MASTER, and MASTER needs the directions in SLAVED.",
    ),
    "P309": ("node slaved to itself", "MASTER is the node itself. Name another node."),
    "P310": (
        "master is slaved",
        "The master follows another node in the same direction. Name the last master of the chain.",
    ),
    "P311": (
        "fixed and slaved",
        "A direction is both fixed and slaved. Remove the letter from FIX or SLAVED.",
    ),
    "P312": ("member without length", "Both ends of a FRAME, BEAM_COLUMN or TENDON are at the same point."),
    "P313": ("property set not used (warning)", "No element has this property set."),
    "P314": ("loose node (warning)", "No element ends at the node, and it is not slaved to another."),
    "P315": ("nothing to analyse", "The deck has no nodes or no elements."),
    "P316": ("no analysis", "The deck requests no analysis. Add a section ANALYSIS."),
    "P317": (
        "nothing moves the model (warning)",
        "A HISTORY has no EQUAKE, FORCES, INITIAL motion or loads that set it in motion. It starts in "
        "the state under its loads, so loads move it only with HELD=NO or FROM=REST.",
    ),
    "P318": (
        "drift without height (warning)",
        "The nodes of a drift are at the same height and no HEIGHT is given, so no drift ratio is printed.",
    ),
    "P319": (
        "gravity not known",
        "The deck has weights, but gravity is not known for these units. Add GRAVITY with its value.",
    ),
    "P320": (
        "weight looks like a node (warning)",
        "WX is the number of a node and WY differs from it. Node lists need commas: 1,2 and not 1 2.",
    ),
    "P321": ("element ends at one node", "Both ends of the element are the same node."),
    "P324": (
        "analysis given twice",
        "A deck can contain one analysis of each kind. For another, run it again with other PARAM values "
        "(--set).",
    ),
    "P325": (
        "initial motion of a fixed or slaved direction",
        "INITIAL gives a displacement or velocity to a direction that is fixed or follows a master. "
        "Give it to a free direction, or to the master.",
    ),
    "P329": (
        "node with two weights (warning)",
        "All nodes of a WEIGHTS line have a weight from another line, or a list names a node twice. "
        "Weights of a node add up. Lines that overlap only partly give no warning.",
    ),
    "P330": (
        "element cannot be built",
        "The values of the element or its property set contradict each other or its nodes. The message "
        "states why; correct the property set, or the line under ELEMENTS that the hint names.",
    ),
    "P331": (
        "loads on an element that is not a member",
        "MEMBER_LOADS act on FRAME and BEAM_COLUMN members only. Load the nodes of springs, dashpots and "
        "contacts under LOADS, or correct the element's number.",
    ),
    "P332": (
        "damping contradictory or not computable",
        "The options of the DAMPING line exclude each other, name one mode twice, or give a negative "
        "ratio. The message states which; the manual's page on damping has the ranges.",
    ),
    "P334": (
        "contact along an inclined line (warning)",
        "A contact without ANGLE acts along the line from I to J, which is inclined if the nodes differ "
        "in height. For floors that meet along x, give ANGLE=0.",
    ),
    "P335": (
        "pushover not possible",
        "The PUSHOVER items exclude each other, its control node cannot move, or its pattern has no "
        "force. PUSHOVER needs TARGET (with CONTROL=FORCE, a FACTOR is enough). FORCES need "
        "PATTERN=FORCES and as many NODES, ADAPTIVE=YES needs PATTERN=MODE; the other patterns need mass.",
    ),
    "P336": (
        "bodies overlap at rest (warning)",
        "GAP is negative: the bodies overlap at rest and press on each other. A distance is positive.",
    ),
    "P337": (
        "structure not connected to the ground (warning)",
        "EQUAKE shakes the base along a direction in which no fixed node, spring, dashpot or contact "
        "holds the structure, and neither INITIAL nor FORCES move it. Fix its base in that direction. "
        "Also given for one building with a height whose supports let it move or turn as one body; "
        "there, contacts count only if they are closed at rest.",
    ),
    "P338": (
        "not a single building, or not a floor",
        "A BUILDINGS line names nodes that elements do not connect, a building that has a name, or a "
        "name already used; or its FLOORS are nodes elsewhere or at levels without mass. A building is "
        "all that elements and slaving connect; contacts do not.",
    ),
    "P339": (
        "building damped twice, or not at all (warning)",
        "DAMPING lines name buildings (BUILDING=), but another building has no line, or one has several, "
        "which add up. Several lines for some NODES or PROPS of a building are allowed. Also given if no "
        "element of PROPS ends at any of the NODES of its line.",
    ),
    "P340": (
        "P-Delta without axial forces (warning)",
        "GEOMETRY requests P-Delta, but no load acts on a building, so it has no effect there; or the "
        "loads are less than 0.3 of its weight (our limit). Weights are masses; STATIC GRAVITY=YES also "
        "makes them loads.",
    ),
    "P341": (
        "damping ratio above one (warning)",
        "XI under DAMPING is a ratio, not percent of critical damping: 5 % is 0.05.",
    ),
    "P342": (
        "gravity in another unit of length (warning)",
        "GRAVITY does not match the unit of length in UNITS, such as 9.81 with mm. All masses are "
        "weights divided by it. Correct one of the two.",
    ),
    "P343": (
        "weight of a fixed node (warning)",
        "The node is fixed, so its mass never moves. A support with its own motion (SUPPORTS) can have "
        "weight. Also given for a node fixed along X alone above the base of a building, if EQUAKE "
        "shakes along X and other nodes of the building swing.",
    ),
    "P344": (
        "drift of one node",
        "Both nodes of the drift are the same. Name the lower and the upper one.",
    ),
    "P345": (
        "too many steps or rows",
        "DT divides the history into more than 100 000 000 steps, or OUTPUT EVERY into more than 5 000 "
        "000 stored rows. The message gives the count and the shortest interval allowed.",
    ),
    "P346": (
        "mode beyond the last (warning)",
        "MODES of a damping model names a mode that the structure does not have. The last mode is used "
        "instead.",
    ),
    "P347": (
        "no mass (warning)",
        "MODAL or EQUAKE needs mass, but nothing has any, or a building with a height has none: it has "
        "no modes, and the ground does not shake it. Or the nodes of its highest beams have none, while "
        "those of others have. Give its floors WEIGHTS.",
    ),
    "P348": (
        "unsupported column foot (warning)",
        "A member ends at or below the height of its building's supports, at a node without FIX along Y "
        "or other elements. One with mass or load is reported only if a member of its property set "
        "stands on a support. Give the node FIX, or join it to the ground.",
    ),
    "P349": (
        "coincident nodes that nothing joins (warning)",
        "A member ends at a node that coincides with another, and no element, contact or SLAVED joins "
        "them: a beam passes the column that should carry it. Let the member end at that node, or join "
        "the two. Touching frames are not reported: columns stand on both sides.",
    ),
    "P350": (
        "elements with the same name (warning)",
        "Elements have the same NAME, for example from a line that generates several. The report cannot "
        "tell them apart. Give each a line and a name, or omit NAME: numbers then replace it.",
    ),
    "P351": (
        "gap above the height of the buildings (warning)",
        "GAP exceeds the heights of both buildings at a contact, so no earthquake closes it. GAP has the "
        "unit of length of UNITS: 20 mm are 0.02 m.",
    ),
    "P352": (
        "section does not fit its member (warning)",
        "A rectangle with the same A and I is sqrt(12 I/A) deep. This is less than a 300th of the length "
        "of a member that bends; or it is more than five times the member's length, and more than the "
        "building's width and height; or A becomes usual if read in mm^2 or cm^2. The limits are ours. "
        "Give A and I in the unit of length of UNITS.",
    ),
    "P353": (
        "member far longer or shorter than others (warning)",
        "A member is over six times the median length of its property set, and is more slender than 1 in "
        "40; or a column between floors is shorter than a quarter of it. The limits are ours. A "
        "coordinate of one of its nodes has a wrong digit.",
    ),
    "P354": (
        "member or contact given twice (warning)",
        "Two members join the same nodes, so their stiffnesses add up; or two contacts of one property "
        "set have the same nodes, direction and gap. Remove one, or correct an end or ANGLE.",
    ),
    "P355": (
        "implausible strength or ductility of hinges (warning)",
        "For a section depth h = sqrt(12 I/A), the yield moment M gives a strain M h/(E I) below 2e-5 or "
        "above 0.1, or DUCTU is above 100; ordinary members have strains of 0.0005 to 0.01 and "
        "ductilities below 50. Or a hinge with KH or a spring with KR yields at a rotation above 0.2; or "
        "the hinges at both ends of a member are together longer than it; or R is 0.2 or more. The "
        "limits are ours. Check the units of yield moments and stiffnesses.",
    ),
    "P356": (
        "mechanism (warning)",
        "EQUAKE shakes along X a building whose base is held, but some of its nodes can move without "
        "resistance: too many ends are pinned, or a member is missing.",
    ),
    "P357": (
        "period does not match the height (warning)",
        "EQUAKE shakes along X a building whose first period T exceeds 2 pi sqrt(H/g), so that it would "
        "topple under its own weight; or it consists of members alone and 4 H/T exceeds 1000 m/s, a "
        "shear wave velocity that walls do not reach. The second limit is ours. The units of weights, "
        "stiffnesses or lengths are inconsistent.",
    ),
    "P358": (
        "contact within a floor (warning)",
        "Horizontal members, or SLAVED along X, connect both nodes of a contact along X, so it cannot "
        "close. Name nodes of two buildings.",
    ),
    "P359": (
        "contact that closes as its nodes move apart (warning)",
        "ANGLE points from J to I. Swap the nodes, or omit ANGLE. A hook is meant to act like this.",
    ),
    "P360": (
        "gap larger than the node distance (warning)",
        "GAP is more than three times the distance of the contact's nodes, which includes the gap and "
        "half of both bodies. The limit is ours. Coincident nodes are not reported.",
    ),
    "P361": (
        "weights do not match the members (warning)",
        "With the masses and the earth's gravity, beams and columns with the E of concrete or steel "
        "weigh more than 0.6 of their building, or its total weight shortens its lowest columns by more "
        "than one per mille. WEIGHTS are forces, not masses; A and E have the units of UNITS. The limits "
        "are ours: bare members are seldom half of a building, and design stresses cause at most 0.8 per "
        "mille.",
    ),
    "P362": (
        "implausible height of a building (warning)",
        "A building is lower than 0.1 m or higher than 1000 m; the limits are ours. Coordinates have the "
        "unit of length of UNITS.",
    ),
    "P363": (
        "implausible strength of springs (warning)",
        "The springs that support a building yield together along X at less than 0.002 or more than 20 "
        "times its weight. Sliding bearings have 0.02, strong walls 3; the limits are ours. Or a spring "
        "yields at a deformation above the height of its building. Check the units.",
    ),
    "P364": (
        "loads that pull upwards (warning)",
        "LOADS and MEMBER_LOADS that pull a building upwards exceed 0.3 of those that press it down; the "
        "limit is ours. Downward loads are negative.",
    ),
    "P365": (
        "steps or rows too far apart (warning)",
        "DT of a HISTORY exceeds a tenth of the first period of every building, or EVERY of OUTPUT "
        "exceeds that period; the limits are ours. Both have the unit of time of UNITS: 5 ms are 0.005 s.",
    ),
    "P366": (
        "hinges that face each other (warning)",
        "Two members end with hinges at a node whose rotation no mass, spring or other member restrains. "
        "Both hinges yield at the same moment and do not harden: only the sum of their rotations is "
        "determined, not which of them turns. Hinges belong at the ends of a column, not at a node "
        "within it. Omit the yield moment at one of the two ends, or give both a rule that hardens, such "
        "as BILINEAR with R.",
    ),
    "P367": (
        "drift of no storey (warning)",
        "The nodes of a drift belong to two buildings, or the first one is the upper one. Drifts with "
        "their own HEIGHT are not reported.",
    ),
    "P368": (
        "contact that misses (warning)",
        "A contact joins floors at two heights, though a node at the same x above or below one of them "
        "is level with the other; or it acts along Y between nodes that lie side by side.",
    ),
    "P369": (
        "implausible stiffness of a contact (warning)",
        "The bodies' weight would compress a contact by more than their buildings' height; or K is 300 "
        "times the axial stiffness EA/L of the beams behind it; or a collision lasts less than 0.1 ms, "
        "too short for sound to cross a column. The limits are ours. K has the units of UNITS.",
    ),
    "P370": (
        "loads do not match the weight (warning)",
        "While the ground shakes: LOADS and MEMBER_LOADS push a building along X by more than half its "
        "weight; they press by 0.7 to 1.4 of its weight with STATIC GRAVITY=YES, which turns WEIGHTS "
        "into loads, so gravity acts twice; they press by less than 0.01 or more than 8 times the "
        "weight; or one floor bears no load while all others do. The limits are ours.",
    ),
    "P371": (
        "overlapping frames (warning)",
        "All nodes of a frame coincide with nodes of another frame that it is not joined to: it is given "
        "twice, or has the X of the other.",
    ),
    "P372": (
        "foot missing in SUPPORTS (warning)",
        "SUPPORTS of EQUAKE move some feet of a building, but a foot that is fixed along X stays still. "
        "Name it too.",
    ),
    "P373": (
        "implausible damping (warning)",
        "With the building's deflected shape under weights along X, DAMPING gives its first mode more "
        "than 20 % of critical damping, or its dashpots give more than 1000 % or less than 0.1 %; or an "
        "earthquake shakes it and nothing damps it; or all OMEGA are below 0.6 of the first circular "
        "frequency. The limits are ours. Check units, and ALPHA and BETA, which are not ratios; XI=0 "
        "states that none is meant.",
    ),
    "P374": (
        "motion across all contacts (warning)",
        "EQUAKE moves the ground along Y alone, but buildings meet at contacts along X.",
    ),
    "P375": (
        "member missing or out of place (warning)",
        "A beam ends above a column that ends below it; no beam joins two columns whose feet one joins; "
        "only one beam of a property set slopes; or an element passes a node from which nothing leads up.",
    ),
    "P376": (
        "no such material (warning)",
        "E of members is below 100 MPa; columns weigh by length what concrete or steel weigh by volume; "
        "or the soil of a footing has G outside 0.5 MPa to 100 GPa, a weight outside 8 to 35 kN/m^3, or "
        "a half width above 100 m. The limits are ours. Values have the units of UNITS.",
    ),
    "P377": (
        "implausible target of a pushover (warning)",
        "TARGET of PUSHOVER exceeds a fifth of the height of its node above the base of its building; "
        "the limit is ours. It is a displacement in the unit of length of UNITS.",
    ),
    "P378": (
        "dashpot not aligned with its nodes (warning)",
        "A DASHPOT with CX alone joins nodes on a slope of 10 to 70 degrees, as in braces, but acts "
        "along X. ANGLE=MEMBER makes it act along the line between them.",
    ),
    "R401": (
        "record not found",
        "The record is neither in the deck's folder nor in the record folders. Check its name, "
        "or add --records DIR.",
    ),
    "R402": (
        "record not readable",
        "The file does not have the FORMAT given. Check the FORMAT and the place named in the message.",
    ),
    "R403": (
        "record count differs",
        "The number of values in the record differs from that in its header. The file may be truncated.",
    ),
    "R404": (
        "record value out of range (error or warning)",
        "A value of the record is not a finite number, or far beyond any earthquake. Check the "
        "units and the columns.",
    ),
    "R405": (
        "motion or force incomplete or contradictory",
        "The line of EQUAKE or FORCES lacks an item, or its items exclude each other. "
        "The message states which.",
    ),
    "R406": (
        "no saved state to restart from",
        "Name the .h5 file of a run of the same structure that ended or had a SAVE time, written by the "
        "same program version; its path is relative to the deck's folder.",
    ),
    "R407": (
        "file both read and written",
        "An output file has the name of the deck, an included file, a record, or a partial result that "
        "RESTART names. Rename one of them, or give another folder with -o.",
    ),
    "R408": (
        "saved state of another deck",
        "A history continues only with the structure, loads, damping and motion it began with. Use the "
        "values of the first run. NEW=MOTION allows another motion; its time begins at zero.",
    ),
    "R409": (
        "record contradicts its header (warning)",
        "The samples are used as they are. The file may have been edited, scaled or cut, or its header "
        "may belong to the unprocessed record. Compare it with the agency's file.",
    ),
    "R410": (
        "no single motion to replace",
        "The motions of a sweep replace the one line under EQUAKE. If a deck has several lines, or none, "
        "name its records by PARAMs.",
    ),
    "R411": (
        "output file name is taken",
        "A file of another program, a folder, a pipe or a device has the name of the results or the "
        "report. Rename it, or give another folder with -o.",
    ),
    "R412": (
        "motion cut or stretched (warning)",
        "START cuts off the peak of a record, or the HISTORY ends before a fifth of an earthquake's "
        "Arias intensity, or a synthetic motion ends within its RISE; or DT makes a record oscillate "
        "faster than on hard rock (every 0.03 s), or slower than on a lake bed (every 1.5 s, and this "
        "times the significant duration above 130 s^2). The limits are ours.",
    ),
    "A501": (
        "unstable structure",
        "The stiffness matrix is singular: some node can move without resistance. The message names"
        " it; add a support or a member.",
    ),
    "A502": (
        "step above the stability limit",
        "The time step of an explicit method exceeds its limit. Use a smaller DT or another METHOD.",
    ),
    "A503": (
        "no progress",
        "Too many events happen at one instant or within one step, or the step falls below its minimum. "
        "Use a shorter DT or METHOD=EXACT; check stiffness and restitution of the contacts. NEWMARK with "
        "EVENTS=STEPPED and a short DT does not search for events and may continue.",
    ),
    "A504": (
        "runaway or not a number",
        "Displacements grew without bound, or a result is not a number. Check DT, damping, strengths and "
        "magnitudes of the deck.",
    ),
    "A505": (
        "method does not suit the model",
        "The chosen METHOD cannot solve this model. The message states why, and which can.",
    ),
    "A506": (
        "interrupted",
        "A signal from the user or the system ended the run. Results up to that time are kept; if older "
        "results exist, in the file whose name ends in .partial.h5.",
    ),
    "A507": (
        "static analysis does not converge",
        "No equilibrium was found. Loads may exceed the strength, or only a contact may support a part.",
    ),
    "A508": (
        "disk full",
        "The disk has no room for the results. Results written before are kept. If older results exist, "
        "the new ones stay in the file whose name ends in .partial.h5. Make room, give another folder "
        "with -o, or store less (OUTPUT EVERY, NODES, MEMBERS, HISTORIES).",
    ),
    "S601": (
        "study is not TOML",
        "The message names the line. Texts are in quotes, lists in brackets; a table begins with [name], "
        "each of several tables of one name with [[name]].",
    ),
    "S602": (
        "unknown item of a study",
        "The study, or one of its tables, has no item of that name. The message names the nearest, or all.",
    ),
    "S603": (
        "value of the wrong kind",
        "The item needs a text, a number, a list or a table, or a number within limits. The message "
        "states which.",
    ),
    "S604": (
        "a file of the study is missing",
        "The study names no deck, or no file fits a pattern. Paths and patterns are relative to the "
        "study's folder; on the command line, to the working folder.",
    ),
    "S605": (
        "items of a study contradict each other",
        "A PARAM has values in two places, zip lists differ in length, an intensity lacks an item, or "
        "two runs are the same. The message states which.",
    ),
    "S606": (
        "record unusable as the study states",
        "The record's file gives another unit, or the record cannot be scaled to the intensity. Put "
        "records that are read differently into separate [[motions]] tables.",
    ),
    "S607": (
        "PARAM without effect",
        "The deck uses the PARAM only for its motion, which the records of the study replace.",
    ),
    "L601": ("3D deck", "The deck is for Ruaumoko-3D. This program reads plane structures only."),
    "L602": (
        "line incomplete",
        "A line of the old deck ends before a required item, or a section before a required line. The "
        "message names what is missing. Items omitted at the end of a line are zero where allowed.",
    ),
    "L603": (
        "invalid number",
        "An item of the old deck is not a number, not a whole number, or outside its limits. One item "
        "too few or too many shifts the numbers after it into wrong columns.",
    ),
    "L604": (
        "unknown code",
        "A code of the old deck requests something whose lines no source documents, or that this program "
        "lacks. Write that part in the language of this program.",
    ),
    "L605": (
        "read by convention (warning)",
        "No source confirms the item's meaning; it is recalled from memory. `pound-solve import` marks "
        "it in the new deck. If an old deck runs without import, this is an error: a result must not "
        "depend on it.",
    ),
    "L606": (
        "basis of the reading (warning)",
        "States that the deck was read as Ruaumoko-2D, and what in it rests on other people's decks.",
    ),
    "L607": (
        "section or line out of place",
        "A section of the old deck is missing or occurs twice, or lines follow the last one its counts "
        "give.",
    ),
    "L608": (
        "number out of order or unknown",
        "A node, member, property set or counter is not defined, or does not ascend to the count in the "
        "control lines. Often a line is missing or superfluous.",
    ),
    "L609": (
        "not carried over (warning)",
        "An item of the old deck has no counterpart, or its effect is not known. If an old deck runs "
        "without import, this is an error.",
    ),
    "L610": (
        "no old deck",
        "`pound-solve import` reads Ruaumoko-2D decks: a title, four lines of control numbers, then "
        "NODES. Decks of this program need no import.",
    ),
    "L611": (
        "record in a separate file",
        "The old deck contains no record. Name its file: `pound-solve import DECK --record FILE -o "
        "model.inp`.",
    ),
    "L612": ("old deck too large", "The file exceeds 256 MB. Put its record into a separate file."),
}

#: codes of warnings, which a card MEANT may name
WARNINGS: Final = tuple(c for c, (title, _) in MESSAGES.items() if "warning)" in title and c[0] in "PR")
