"""Telegrams of the R-protocol, from the fact sheet `melfa`; the section stands with each.

Robots of the captures are older arms with six and eight axes; a SCARA's emulator has other values in the same layout.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Exchange:
    """One request with its answer.

    Attributes:
        section: of the sheet.
        request: without header and terminator.
        answer: whole, without terminator.
    """

    section: str
    request: str
    answer: str


OPEN_SIX = Exchange(
    "1.8",
    "OPEN=NARCUSR",
    "QoK3F;3F;7,0;3,5,A,1E,32,46,64;MB4;PRM;RV-1A;CRn-5xx;MELFA;09-08-08;Ver.K9b;ENG;COPYRIGHT;1;1;8;",
)
OPEN_EIGHT = Exchange(
    "1.8",
    "OPEN=NARCUSR",
    "QoKFF;FF;7,0;3,5,A,1E,32,46,64;MB5;PRM;RV-13FLM-D;CRnX-7xx;MELFA;17-10-06;Ver.S7e;ENG;COPYRIGHT;1;3;8;",
)
"""The text of the copyright is left open in the sheet."""

STATE_IDLE = Exchange("1.10", "STATE", "QoK;0;100;0;01120;0;1;;;;;;;;;REP;START;1;0")
STATE_PAUSED = Exchange("1.10", "STATE", "QoKKAMAL.MB4;1196;50;4;08860;1196;1;;;;;;;;;REP;START;1;0")
DSTATE = Exchange("1.10", "DSTATE", "QoK09060;17;1")

JOINTS_SIX = Exchange(
    "1.11",
    "JPOSF",
    "QoKJ1;-16.28;J2;38.72;J3;102.51;J4;16.73;J5;6.06;J6;-19.16;;****,****;75;0.00;00000000",
)
JOINTS_EIGHT = Exchange(
    "1.11",
    "JPOSF",
    "QokJ1;0.00;J2;0.00;J3;0.00;J4;0.00;J5;0.00;J6;0.00;J7;0.00;J8;0.00;;****,****;100;0.00;00000000",
)
POSITION_SIX = Exchange(
    "1.11",
    "PPOSF",
    "QoKX;351.84;Y;-100.49;Z;366.25;A;179.89;B;33.00;C;166.72;;7,0;75;0.00;00000000",
)
POSITION_FLAGS = Exchange(
    "1.11",
    "PPOSF",
    "QoKX;176.01;Y;33.14;Z;541.62;A;77.92;B;-25.59;C;106.80;;6,15728640;100;0.00;00000000",
)

SIGNALS = Exchange("1.12", "IOSIGNAL0;0", "QoK00000002")
ORIGIN = Exchange("1.12", "CALIB", "QoKN3F3F")

NO_ERROR = Exchange("1.13", "ERROR", "QoK")
ERROR = Exchange("1.13", "ERROR", "Qok4140;2")

NUMBER = Exchange("1.14", "VALM1", "QoKM1=+3")
SERVO = Exchange("1.14", "VALM_SVO", "QoKM_SVO=+1")
POSITION_VALUE = Exchange("1.14", "VALP1", "QoKP1=(+400.13,+0.00,+644.62,+180.00,+0.00,+180.00)(7,0)")
LINE_COUNT = Exchange("1.14", "LISTCNT", "QoK0005")
TIME = Exchange("1.14", "TIME", "QoK04-02-0917:54:32")
DIRECTORY = Exchange(
    "1.14", "PDIRTOP", "QoK1.MB4;4767;24-02-2821:05:14;2;220160;12;;9;82;135256;6848;9661;14"
)
LANGUAGE = Exchange("1.8", "PARRLNG", "QoKRLNG;1;1")
TOOL = Exchange("1.8", "PARMEXTL", "QoKMEXTL;0.00, 0.00, 0.00, 0.00, 0.00, 0.00;6")

NO_RIGHT = Exchange("1.6", "SRVON", "QeR602000000")
BAD_SLOT = Exchange("1.6", "STATE", "QeR512000000")

COMPOSITES = {
    "01120": "idle, repeat, STOP, program select enabled",
    "09060": "repeat, TEACH, STOP, WAIT",
    "20060": "servo on, STOP, WAIT",
    "A0060": "right, servo on, STOP, WAIT",
    "80060": "right, STOP, WAIT",
    "08860": "TEACH, 80 and 06 of the stop status",
    "60000": "servo on, running",
    "A1124220": "right, servo on, repeat, STOP, program select enabled, error 4220",
}
"""Run status, stop status and error of section 1.10, as observed."""

REPLAYED = (
    "3F;3F;7,0;3,5,A,1E,32,46,64;MB4;PRM;RV-3SB;CRn-5xx;MELFA;05-07-14;Ver.K4a;ENG;TEXT;1;1;8;",
    "RLNG;1;1",
    "1.MB4;4767;24-02-2821:05:14;2;220160;12;;9;82;135256;6848;9661;14",
    "X;176.01;Y;33.14;Z;541.62;A;77.92;B;-25.59;C;106.80;;6,15728640;100;0.00;00000000",
    "MEXTL;0.00, 0.00, 0.00, 0.00, 0.00, 0.00;6",
)
"""Section 1.14: answers that one client sends as if they were commands."""

ANSWERS_IN_LAYOUT = (
    OPEN_SIX,
    OPEN_EIGHT,
    STATE_PAUSED,
    DSTATE,
    JOINTS_SIX,
    JOINTS_EIGHT,
    POSITION_SIX,
    POSITION_VALUE,
    TIME,
    DIRECTORY,
)
"""Answers whose values differ from robot to robot."""

STARTS = (
    (
        "OPEN=NARCUSR",
        "PARRLNG",
        "PDIRTOP",
        "PPOSF",
        "PARMEXTL",
        "KEYWDptest",
        "CNTLON",
        "RSTALRM",
        "SRVON",
        "STATE",
    ),
    ("OPEN=NARCUSR", "CNTLON", "RSTPRG", "PRGLOAD=COSIROP", "OVRD=50", "SRVON", "SRVOFF", "CNTLOFF", "CLOSE"),
    (
        "OPEN=NARCUSER",
        "CNTLON",
        "EXECSPD M_NSPD",
        "EXECJOVRD M_NJOVRD",
        "EXECOVRD M_NOVRD",
        "OVRD",
        "OVRD=10.0",
        "SRVON",
        "VALM_SVO",
        "EXECBASE P_NBASE",
        "EXECDEF POS P1",
        "EXECBASE (0,0,0,,,)",
        "EXECTOOL (0,0,0,0,0,0)",
        "PNRMEXTL",
    ),
)
"""Section 1.8: how three known clients begin; the second one needs a program COSIROP."""
