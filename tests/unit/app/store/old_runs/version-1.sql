PRAGMA user_version=1;
BEGIN TRANSACTION;
CREATE TABLE meta (
    key TEXT PRIMARY KEY, value TEXT NOT NULL CHECK (json_valid(value))
) STRICT;
CREATE TABLE steps (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, title TEXT NOT NULL,
    started_utc TEXT NOT NULL, done_utc TEXT NOT NULL, row_count INTEGER NOT NULL,
    result TEXT NOT NULL CHECK (json_valid(result)),
    PRIMARY KEY (step_id, attempt)
) STRICT;
CREATE TABLE points (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    reflector TEXT NOT NULL, segment INTEGER NOT NULL,
    theta1_deg REAL NOT NULL, theta2_deg REAL NOT NULL, j3_mm REAL NOT NULL, j4_deg REAL NOT NULL,
    reported1_deg REAL NOT NULL, reported2_deg REAL NOT NULL,
    reported3_mm REAL NOT NULL, reported4_deg REAL NOT NULL,
    direction1 INTEGER NOT NULL, direction2 INTEGER NOT NULL,
    displacement_mm REAL NOT NULL, spread_mm REAL NOT NULL, readings INTEGER NOT NULL, signal REAL NOT NULL,
    time_utc TEXT NOT NULL, duration_s REAL NOT NULL,
    temperature_c REAL, pressure_hpa REAL, humidity_percent REAL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
CREATE TABLE search (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    reflector TEXT NOT NULL, theta1_deg REAL NOT NULL, theta2_deg REAL NOT NULL,
    j4_deg REAL, lower_deg REAL, upper_deg REAL, signal REAL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
CREATE TABLE path (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    x_mm REAL NOT NULL, y_mm REAL NOT NULL, theta1_deg REAL NOT NULL, theta2_deg REAL NOT NULL,
    direction1 INTEGER NOT NULL, direction2 INTEGER NOT NULL,
    x_meas_mm REAL, y_meas_mm REAL, u_mm REAL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
CREATE TABLE events (
    seq INTEGER PRIMARY KEY, time_utc TEXT NOT NULL, kind TEXT NOT NULL,
    data TEXT NOT NULL CHECK (json_valid(data))
) STRICT;
CREATE TABLE prompts (
    seq INTEGER PRIMARY KEY, id TEXT NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL,
    asked_utc TEXT NOT NULL, answered_utc TEXT, answer TEXT, who TEXT
) STRICT;
INSERT INTO "events" VALUES(1,'2025-01-02T00:00:01+00:00','run-opened','{}');
INSERT INTO "events" VALUES(2,'2025-01-02T00:00:04+00:00','run-ended','{"status":"stopped","exit_code":5,"text":"enough"}');
INSERT INTO "meta" VALUES('run','"20250102T000001Z_open-loop_0a1b2c"');
INSERT INTO "meta" VALUES('procedure','"open-loop"');
INSERT INTO "meta" VALUES('software','{"catseye":"0.0.1"}');
INSERT INTO "meta" VALUES('cell','"lab-1"');
INSERT INTO "meta" VALUES('simulated','true');
INSERT INTO "meta" VALUES('operator','"ada"');
INSERT INTO "meta" VALUES('params','{"reflectors":[]}');
INSERT INTO "meta" VALUES('aim','"cell file"');
INSERT INTO "meta" VALUES('configuration','{"format":"catseye-cell/1","name":"lab-1","robot":{"endpoint":"tcp://127.0.0.1:10001","link1_mm":325.0,"link2_mm":225.0,"j3_mm":50.0,"j3_range_mm":[40.0,60.0]},"interferometer":{"profile":"default","endpoint":"tcp://127.0.0.1:10002"},"environment":{"endpoint":"tcp://127.0.0.1:10502","map":"vaisala","pressure_register":44},"tracker":{"endpoint":"tcp://127.0.0.1:10099"},"optics":{"signal_min":0.1},"conditions":{"temperature_c":[15.0,25.0],"pressure_hpa":[800.0,1100.0],"humidity_percent":[5.0,90.0]},"reflector":[{"name":"P1","x_mm":650.0,"y_mm":-400.0},{"name":"P2","x_mm":680.0,"y_mm":0.0},{"name":"P3","x_mm":640.0,"y_mm":380.0}],"measurement":{"theta1_deg":[-140.0,-120.0,-100.0,-80.0,-60.0,-40.0,-20.0,0.0,20.0,40.0,60.0],"theta2_deg":[0.0,20.0,40.0,60.0,80.0,100.0,120.0,140.0]},"workspace":{"flange":{"z_mm":200.0}}}');
INSERT INTO "points" VALUES('P1/0000',1,1,'P1',0,1.0,2.0,0.0,3.0,1.0,2.0,0.0,3.0,1,-1,0.1,0.0,5,0.9,'2026-01-02T03:04:05+00:00',0.5,20.0,NULL,50.0,'{}');
INSERT INTO "search" VALUES('look',1,1,'P1',1.0,2.0,3.5,NULL,NULL,NULL,'{}');
INSERT INTO "steps" VALUES('P1/0000',1,'P1: first','2025-01-02T00:00:01+00:00','2025-01-02T00:00:02+00:00',1,'{"measured":true,"segment":0}');
INSERT INTO "steps" VALUES('look',1,'look','2025-01-02T00:00:02+00:00','2025-01-02T00:00:03+00:00',1,'{"found":true}');
CREATE TRIGGER meta_no_update BEFORE UPDATE ON meta BEGIN SELECT RAISE(ABORT, 'meta is append-only'); END;
CREATE TRIGGER meta_no_delete BEFORE DELETE ON meta BEGIN SELECT RAISE(ABORT, 'meta is append-only'); END;
CREATE TRIGGER steps_no_update BEFORE UPDATE ON steps BEGIN SELECT RAISE(ABORT, 'steps is append-only'); END;
CREATE TRIGGER steps_no_delete BEFORE DELETE ON steps BEGIN SELECT RAISE(ABORT, 'steps is append-only'); END;
CREATE TRIGGER points_no_update BEFORE UPDATE ON points BEGIN SELECT RAISE(ABORT, 'points is append-only'); END;
CREATE TRIGGER points_no_delete BEFORE DELETE ON points BEGIN SELECT RAISE(ABORT, 'points is append-only'); END;
CREATE TRIGGER search_no_update BEFORE UPDATE ON search BEGIN SELECT RAISE(ABORT, 'search is append-only'); END;
CREATE TRIGGER search_no_delete BEFORE DELETE ON search BEGIN SELECT RAISE(ABORT, 'search is append-only'); END;
CREATE TRIGGER path_no_update BEFORE UPDATE ON path BEGIN SELECT RAISE(ABORT, 'path is append-only'); END;
CREATE TRIGGER path_no_delete BEFORE DELETE ON path BEGIN SELECT RAISE(ABORT, 'path is append-only'); END;
CREATE TRIGGER events_no_update BEFORE UPDATE ON events BEGIN SELECT RAISE(ABORT, 'events is append-only'); END;
CREATE TRIGGER events_no_delete BEFORE DELETE ON events BEGIN SELECT RAISE(ABORT, 'events is append-only'); END;
CREATE TRIGGER prompts_no_update BEFORE UPDATE ON prompts BEGIN SELECT RAISE(ABORT, 'prompts is append-only'); END;
CREATE TRIGGER prompts_no_delete BEFORE DELETE ON prompts BEGIN SELECT RAISE(ABORT, 'prompts is append-only'); END;
COMMIT;
