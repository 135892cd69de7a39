"""Invented files in the formats of agencies, written from the layouts for the tests of their readers."""

from __future__ import annotations

from collections.abc import Sequence

#: twenty accelerations [cm/s2]; the peak fills its ten columns when printed with five decimals
SAMPLES = (0.5, -1.25, 3.0, 1019.12345, -900.5, *(0.25 * k for k in range(-7, 8)))


def rows(values: Sequence[float], layout: str, per_line: int) -> list[str]:
    """Numbers in columns as Fortran prints them, without a blank where they fill theirs."""
    words = [format(x, layout) for x in values]
    return ["".join(words[k : k + per_line]) for k in range(0, len(words), per_line)]


def short_exponent(x: float) -> str:
    """A number as SMC files print it: ten characters, the exponent without zeros in front."""
    mantissa, _, exponent = f"{x:.4E}".partition("E")
    return f"{mantissa}E{int(exponent):+d}".rjust(10)


def smc(
    values: Sequence[float] = SAMPLES,
    kind: str = "2 CORRECTED ACCELEROGRAM",
    declared: int | None = None,
    rate: float = 200.0,
    peak: float | None = None,
    tilt: int = 90,
    azimuth: int = 360,
) -> str:
    """An SMC file; `values` are times and accelerations in turn where `rate` is 1.7e38."""
    integers = [-32768] * 48
    integers[12:14], integers[15], integers[16] = [tilt, azimuth], 2, declared or len(values)
    reals = [1.7e38] * 50
    reals[1], reals[29], reals[31] = rate, peak or max(values), min(values)
    lines = [kind, "*", "NONE", " 1903 2 1 Nowhere", "Moment Mag=", "station = Invented", *["*"] * 5]
    lines += rows(integers, "10d", 8) + rows(reals, "15.7E", 5) + ["|", "| no such station"]
    words = [short_exponent(x) for x in values]
    lines += ["".join(words[k : k + 8]) for k in range(0, len(words), 8)]
    return "\r\n".join(lines) + "\r\n"


def cosmos_part(
    values: Sequence[float],
    unit: str = "cm/sec2(04)",
    quantity: str = "acceleration",
    azimuth: int = 340,
    declared: int | None = None,
    peak: float | None = None,
) -> str:
    """One component of a COSMOS file, sampled each 5 ms."""
    integers, reals = [-999] * 100, [-999.0] * 100
    integers[:3], integers[53] = [2, 1, 4], azimuth
    reals[61:64] = [5.0, 0.005 * len(values), peak or max(values, key=abs)]
    lines = ["Corrected acceleration    (Format v01.20 with 13 text lines) Src: none", *["Invented"] * 12]
    lines += [" 100 Integer-header values follow on  10 lines, Format= (10I8)", *rows(integers, "8d", 10)]
    lines += [" 100 Real-header values follow on  17 lines, Format= (6F13.6)", *rows(reals, "13.6f", 6)]
    lines += ['  1 Comment line(s) follow, each starting with a "|":', "| no such station"]
    lines += [
        f"{declared or len(values):7d}  {quantity} pts, approx    1 secs, units={unit},Format=(8F10.5)",
        *rows(values, "10.5f", 8),
        "End-of-data for Chan  1",
    ]
    return "\n".join(lines) + "\n"


def cosmos() -> str:
    """A COSMOS file of three components, the vertical one first."""
    parts = (400, tuple(0.5 * x for x in SAMPLES)), (340, SAMPLES), (70, tuple(0.25 * x for x in SAMPLES))
    return "".join(cosmos_part(values, azimuth=azimuth) for azimuth, values in parts)


def csmip(
    names: Sequence[str] = ("90 Deg", "Up", "360 Deg"),
    unit: str = "in cm/sec2. (8f10.5)",
    step: str = ".005",
    exact: float = 0.005,
    declared: int | None = None,
    peak: float | None = None,
) -> str:
    """A CSMIP V2 file; component k has k times the samples."""
    lines: list[str] = []
    for k, name in enumerate(names, 1):
        values = [x / k for x in SAMPLES]
        lines += [f"Corrected accelerogram   00000-X-0             Chan {k:2d}: {name:12s} from"]
        lines += ["Uncorrected Accelerogram Data             Processed: 01/02/03, none"]
        lines += ["Invented"] * 5 + [f"Chan {k:2d}: {name}"] + ["Invented"] * 17
        reals = [0.0] * 100
        reals[60], reals[65] = exact, peak or values[3]
        # columns filled to the last character, as real headers have them
        reals[10:12] = [-999.0, 4996.0580]
        lines += rows([-999] * 100, "5d", 16) + [
            row.replace("-999.0000 ", "-999.00000") for row in rows(reals, "10.5f", 8)
        ]
        n = declared or len(values)
        lines += [f"{n:6d} points of accel data equally spaced at {step} sec, {unit}"]
        lines += rows(values, "10.5f", 8)
        for quantity in ("veloc", "displ"):
            lines += [f"{n:6d} points of {quantity} data equally spaced at {step} sec, in cm. (8f10.5)"]
            lines += rows([9.0] * len(values), "10.5f", 8)
        lines += [f"/&  ----------  End of data for channel {k:2d}  ----------"]
    return "\r\n".join(lines) + "\r\n"


def knet(
    readings: Sequence[int] = (-12085, -12080, -12090, 7915, -32085, *(-12085,) * 95),
    scale: str = "3920(gal)/6182761",
    rate: str = "100Hz",
    length: str = "1",
    peak: str = "12.681",
    direction: str = "E-W",
) -> str:
    """A K-NET file of one second whose mean reading is -12085."""
    entries = {
        "Origin Time": "1903/02/01 00:00:00",
        "Lat.": "0.0",
        "Long.": "0.0",
        "Depth. (km)": "0",
        "Mag.": "0.0",
        "Station Code": "NON000",
        "Station Lat.": "0.0",
        "Station Long.": "0.0",
        "Station Height(m)": "0",
        "Record Time": "1903/02/01 00:00:15",
        "Sampling Freq(Hz)": rate,
        "Duration Time(s)": length,
        "Dir.": direction,
        "Scale Factor": scale,
        "Max. Acc. (gal)": peak,
        "Last Correction": "1903/02/01 00:00:00",
        "Memo.": "",
    }
    lines = [f"{name:18s}{value}" for name, value in entries.items()] + rows(readings, "9d", 8)
    return "\n".join(lines) + "\n"


def esm(values: Sequence[float] = SAMPLES, **changes: str) -> str:
    """An ESM file; `changes` replace entries of its header."""
    entries = {
        "EVENT_NAME": "NOWHERE",
        "EVENT_ID": "",
        "STATION_NAME": "Invented: none, nowhere",
        "VS30_M/S": "",
        "SAMPLING_INTERVAL_S": "0.005000",
        "NDATA": str(len(values)),
        "DURATION_S": f"{0.005 * len(values):.3f}",
        "STREAM": "HNE",
        "UNITS": "cm/s^2",
        "PGA_CM/S^2": f"{max(values, key=abs):.6f}",
        "HEADER_FORMAT": "DYNA 1.2",
        "DATA_TYPE": "ACCELERATION",
        "USER1": "",
    } | changes
    lines = [f"{name}: {value}" for name, value in entries.items()] + [f"{x:.6f}" for x in values]
    return "\n".join(lines) + "\n"


def afad(declared: int | None = None, step: str = "0.01", peak: str = "1019.123450") -> str:
    """A file of AFAD's older archive; E-W and U-D are half and a quarter of N-S."""
    lines = ["STRONG GROUND MOTION RECORDS OF TURKIYE", "PLACE                   : NOWHERE"]
    lines += [f"NUMBER OF DATA          : {declared or len(SAMPLES)}"]
    lines += [f"SAMPLING INTERVAL (sec) : {step}"]
    lines += [f"RAW PGA VALUES (gal)    : (N-S) {peak} (E-W) 509.561725 (U-D) 254.780862"]
    lines += ["Copyright nobody", "       N-S          E-W          U-D"]
    lines += [f"{x:12.6f}  {x / 2:12.6f} {x / 4:12.6f}" for x in SAMPLES]
    return "\r\n".join(lines) + "\r\n"


def unam(thinned: str = "1", declared: int | None = None, unit: str = "Gal (cm/s/s)") -> str:
    """A file of the UNAM; N00E and N90E are half and a quarter of V."""
    n = declared or len(SAMPLES)
    entries = {
        "VERSION DEL FORMATO": "2.0",
        "NUMERO DE CANALES": "3",
        "ORIENTACION C1-C6 (rumbo;orientacion)": "/V/N00E/N90E",
        "ORIENTACION C7-C12 (rumbo;orientacion)": "",
        "INTERVALO DE MUESTREO, C1-C6 (s)": "/0.005/0.005/0.005",
        "INTERVALO DE MUESTREO, C7-C12 (s)": "",
        "NUM. TOTAL DE MUESTRAS, C1-C6": f"/{n}/{n}/{n}",
        "ACEL. MAX.(Gal), C1-C6": "/1019.1235/509.5617/254.7809",
        "ACEL. MAX., C1-C6, EN LA MUESTRA": "/4/4/4",
        "UNIDADES DE LOS DATOS": unit,
        "FACTOR DE DECIMACION": thinned,
        "FORMATO DATOS (FORTRAN,10 campos/dato)": "3F10.4",
    }
    lines = ["*" * 86, "        INSTITUTO INVENTADO", "*" * 86, "ARCHIVO ESTANDAR DE ACELERACION:"]
    lines += [f"{name:39s}: {value}" for name, value in entries.items()]
    rule = "---------+" * 8
    lines += ["=" * 80, "DATOS DE ACELERACION:", rule, "   CANAL-1   CANAL-2   CANAL-3"]
    lines += ["         V      N00E      N90E", rule]
    lines += ["".join(rows([x, x / 2, x / 4], "10.4f", 3)) for x in SAMPLES]
    return "\r\n".join(lines) + "\r\n"


#: a sound file of every format
FILES = {
    "SMC": smc(),
    "COSMOS": cosmos(),
    "CSMIP": csmip(),
    "KNET": knet(),
    "ESM": esm(),
    "AFAD": afad(),
    "UNAM": unam(),
    "PEER": "PEER\nx, y, 090\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .0050 SEC,\n .1E-01 -.2 .3D0-.4\n",
    "BERG": "Title\n0.00 0.00 0.02 0.10 0.03 -0.20 0.06 0.30\n0.08 -0.05 0.10 0.00\n",
    "COLUMNS": "t, a\n0.00, 0.1\n0.01, -0.2\n0.02, 0.3\n",
}
