PRAGMA user_version=4;
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
    extra TEXT NOT NULL CHECK (json_valid(extra)), raw_displacement_mm REAL, refractive_index REAL, zero_refractive_index REAL, dead_path_mm REAL, formula TEXT,
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
CREATE TABLE records (
    step_id TEXT NOT NULL, attempt INTEGER NOT NULL, seq INTEGER NOT NULL,
    kind TEXT NOT NULL,
    extra TEXT NOT NULL CHECK (json_valid(extra)),
    PRIMARY KEY (step_id, attempt, seq)
) STRICT;
CREATE TABLE journal (
    place INTEGER PRIMARY KEY, of TEXT NOT NULL, row INTEGER NOT NULL, crc32 INTEGER NOT NULL,
    UNIQUE (of, row)
) STRICT;
INSERT INTO "events" VALUES(1,'2026-01-02T00:00:03+00:00','run-opened','{}');
INSERT INTO "events" VALUES(2,'2026-01-02T00:00:07+00:00','warning','{"text":"look there"}');
INSERT INTO "events" VALUES(3,'2026-01-02T00:00:10+00:00','run-ended','{"status":"stopped","exit_code":5,"sealed":true,"wire_lines_cut":0,"wire_bytes_cut":0,"log_lines_cut":0,"clock_anchor":{"utc":"2026-01-02T00:00:09+00:00","monotonic_s":9.0},"text":"enough"}');
INSERT INTO "journal" VALUES(1,'meta',1,1899970215);
INSERT INTO "journal" VALUES(2,'meta',2,4072867506);
INSERT INTO "journal" VALUES(3,'meta',3,1169088697);
INSERT INTO "journal" VALUES(4,'meta',4,2403147316);
INSERT INTO "journal" VALUES(5,'meta',5,1516726300);
INSERT INTO "journal" VALUES(6,'meta',6,1924144723);
INSERT INTO "journal" VALUES(7,'meta',7,2816088395);
INSERT INTO "journal" VALUES(8,'meta',8,469246262);
INSERT INTO "journal" VALUES(9,'meta',9,726651719);
INSERT INTO "journal" VALUES(10,'meta',10,881518220);
INSERT INTO "journal" VALUES(11,'events',1,3057142324);
INSERT INTO "journal" VALUES(12,'steps',1,1805704058);
INSERT INTO "journal" VALUES(13,'points',1,3770545075);
INSERT INTO "journal" VALUES(14,'steps',2,2859035140);
INSERT INTO "journal" VALUES(15,'records',1,4253742013);
INSERT INTO "journal" VALUES(16,'points',2,4197784397);
INSERT INTO "journal" VALUES(17,'steps',3,3135995913);
INSERT INTO "journal" VALUES(18,'search',1,295616424);
INSERT INTO "journal" VALUES(19,'path',1,2913971437);
INSERT INTO "journal" VALUES(20,'events',2,949468892);
INSERT INTO "journal" VALUES(21,'prompts',1,3230019810);
INSERT INTO "journal" VALUES(22,'events',3,3480786326);
INSERT INTO "meta" VALUES('run','"20260102T000001Z_open-loop_0a1b2c"');
INSERT INTO "meta" VALUES('procedure','"open-loop"');
INSERT INTO "meta" VALUES('software','{"catseye":"0.1.0","python":"3.11.2","sqlite":"3.40.1","numpy":"1.26.4","platform":"Linux","host":"bench","pid":1}');
INSERT INTO "meta" VALUES('clock_anchor','{"utc":"2026-01-02T00:00:02+00:00","monotonic_s":2.0}');
INSERT INTO "meta" VALUES('cell','"lab-1"');
INSERT INTO "meta" VALUES('simulated','true');
INSERT INTO "meta" VALUES('operator','"ada"');
INSERT INTO "meta" VALUES('params','{"reflectors":[]}');
INSERT INTO "meta" VALUES('aim','"cell file"');
INSERT INTO "meta" VALUES('configuration','{"format":"catseye-cell/1","name":"lab-1","robot":{"driver":"melfa-r3","endpoint":"tcp://127.0.0.1:10001","datalink_endpoint":null,"mxt_endpoint":null,"settings":{},"arm":"rh-3frh5515","expected_model":"RH-3FRH5515","link1_mm":325.0,"link2_mm":225.0,"j3_mm":50.0,"j3_range_mm":[40.0,60.0],"override_cap_percent":20.0,"override_cap_reason":"","speed_deg_s":[420.0,720.0,3000.0],"j3_speed_mm_s":1100.0,"acceleration_deg_s2":[2000.0,4000.0,15000.0],"follow_speed_deg_s":20.0,"follow_acceleration_deg_s2":200.0,"limits_deg":{"j1":[-170.0,170.0],"j2":[-145.0,145.0],"j4":[-360.0,360.0]},"drives_off_after_s":300.0},"interferometer":{"driver":"line-counter","profile":"default","endpoint":"tcp://127.0.0.1:10002","settings":{}},"environment":{"driver":"modbus-air","endpoint":"tcp://127.0.0.1:10502","map":"vaisala","pressure_register":44,"settings":{}},"air":{"formula":"ciddor","co2_ppm":450.0,"vacuum_wavelength_nm":632.9908,"max_age_s":2.0},"io":null,"material":null,"tracker":{"driver":"bench-tracker","endpoint":"tcp://127.0.0.1:10099"},"device":[],"optics":{"acceptance_mm":1.0,"max_miss_mm":0.2,"field_half_angle_deg":80.0,"column_radius_mm":110.0,"column_margin_mm":5.0,"beam_min_mm":50.0,"beam_max_mm":5000.0,"theta40_deg":0.0,"signal_min":0.1,"one_reflector":false},"alignment":{"stage_mm_per_turn":0.5,"stage_clockwise":"+y","offset_tolerance_mm":0.1,"level_mrad_per_turn":2.0,"level_clockwise":"up","level_tolerance_mrad":0.2},"conditions":{"temperature_c":[15.0,25.0],"pressure_hpa":[800.0,1100.0],"humidity_percent":[5.0,90.0]},"engine":{"on_client_lost":"hold"},"reflector":[{"name":"P1","x_mm":650.0,"y_mm":-400.0,"facing_deg":null},{"name":"P2","x_mm":680.0,"y_mm":0.0,"facing_deg":null},{"name":"P3","x_mm":640.0,"y_mm":380.0,"facing_deg":null}],"measurement":{"theta1_deg":[-140.0,-120.0,-100.0,-80.0,-60.0,-40.0,-20.0,0.0,20.0,40.0,60.0],"theta2_deg":[0.0,20.0,40.0,60.0,80.0,100.0,120.0,140.0],"settle_time_s":0.5,"dwell_time_s":0.5,"readings":10,"take_up_deg":1.0,"spread_limit_um":5.0},"uncertainty":{"contributor":[{"name":"wavelength","kind":"scale","value_um":null,"value_ppm":0.054,"value_mdeg":null,"value_mrad":null,"distribution":"normal","correlation":"common","axis":null,"orders":5,"degrees_of_freedom":null},{"name":"wavelength correction","kind":"scale","value_um":null,"value_ppm":0.256,"value_mdeg":null,"value_mrad":null,"distribution":"normal","correlation":"common","axis":null,"orders":5,"degrees_of_freedom":null},{"name":"environmental change","kind":"length","value_um":0.09,"value_ppm":null,"value_mdeg":null,"value_mrad":null,"distribution":"normal","correlation":"reading","axis":null,"orders":5,"degrees_of_freedom":null},{"name":"repeatability of the robot","kind":"length","value_um":10.0,"value_ppm":null,"value_mdeg":null,"value_mrad":null,"distribution":"normal","correlation":"reading","axis":null,"orders":5,"degrees_of_freedom":null},{"name":"radial error motion of J1","kind":"radial","value_um":5.0,"value_ppm":null,"value_mdeg":null,"value_mrad":null,"distribution":"normal","correlation":"axis-angle","axis":"j1","orders":5,"degrees_of_freedom":null},{"name":"radial error motion of J2","kind":"radial","value_um":5.0,"value_ppm":null,"value_mdeg":null,"value_mrad":null,"distribution":"normal","correlation":"axis-angle","axis":"j2","orders":5,"degrees_of_freedom":null},{"name":"radial error motion of J4","kind":"radial","value_um":10.0,"value_ppm":null,"value_mdeg":null,"value_mrad":null,"distribution":"normal","correlation":"axis-angle","axis":"j4","orders":5,"degrees_of_freedom":null},{"name":"beam direction, J1","kind":"direction","value_um":null,"value_ppm":null,"value_mdeg":null,"value_mrad":0.717,"distribution":"normal","correlation":"reading","axis":null,"orders":5,"degrees_of_freedom":null},{"name":"beam direction, J2","kind":"direction","value_um":null,"value_ppm":null,"value_mdeg":null,"value_mrad":0.717,"distribution":"normal","correlation":"reading","axis":null,"orders":5,"degrees_of_freedom":null}]},"workspace":{"clearance_mm":5.0,"table":{"z_mm":0.0,"confirmed":false},"stands":{"radius_mm":15.0,"confirmed":false},"flange":{"z_mm":200.0,"confirmed":false},"keep_out":[],"keep_in":[]},"body":[]}');
INSERT INTO "path" VALUES('look',1,1,1.0,2.0,3.0,4.0,1,-1,NULL,NULL,NULL,'{"pass_number":0}');
INSERT INTO "points" VALUES('P1/0000',1,1,'P1',0,1.0,2.0,0.0,3.0,1.0,2.0,0.0,3.0,1,-1,0.1,0.0,5,0.9,'2026-01-02T03:04:05+00:00',0.5,20.0,NULL,50.0,'{"material_c":21.5}',NULL,NULL,NULL,NULL,NULL);
INSERT INTO "points" VALUES('P1/0001',1,1,'P1',0,2.0,2.0,0.0,3.0,1.0,2.0,0.0,3.0,1,-1,0.1,0.0,5,0.9,'2026-01-02T03:04:05+00:00',0.5,20.0,NULL,50.0,'{}',0.1001,1.00027,NULL,NULL,'ciddor');
INSERT INTO "prompts" VALUES(1,'place/P1','confirm','Put it there.','2026-01-02T00:00:09+00:00','2026-01-02T00:00:08+00:00','yes','ada');
INSERT INTO "records" VALUES('P1/0001',1,1,'overlap','{"reflector":"P1","segment":1,"theta1_deg":1.0,"theta2_deg":2.0,"j3_mm":0.0,"j4_deg":3.0,"reported1_deg":1.0,"reported2_deg":2.0,"reported3_mm":0.0,"reported4_deg":3.0,"direction1":1,"direction2":-1,"displacement_mm":0.1,"spread_mm":0.0,"readings":5,"signal":0.9,"temperature_c":20.0,"pressure_hpa":null,"humidity_percent":50.0,"time_utc":"2026-01-02T03:04:05+00:00","duration_s":0.5,"point":0,"previous_segment":0}');
INSERT INTO "search" VALUES('look',1,1,'P1',1.0,2.0,3.5,NULL,NULL,NULL,'{}');
INSERT INTO "steps" VALUES('P1/0000',1,'P1: first','2026-01-02T00:00:04+00:00','2026-01-02T00:00:04+00:00',1,'{"measured":true,"segment":0}');
INSERT INTO "steps" VALUES('P1/0001',1,'P1: second','2026-01-02T00:00:05+00:00','2026-01-02T00:00:05+00:00',2,'{"measured":true,"segment":1}');
INSERT INTO "steps" VALUES('look',1,'look','2026-01-02T00:00:06+00:00','2026-01-02T00:00:06+00:00',2,'{"found":true}');
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
CREATE TRIGGER records_no_update BEFORE UPDATE ON records BEGIN SELECT RAISE(ABORT, 'records is append-only'); END;
CREATE TRIGGER records_no_delete BEFORE DELETE ON records BEGIN SELECT RAISE(ABORT, 'records is append-only'); END;
CREATE TRIGGER journal_no_update BEFORE UPDATE ON journal BEGIN SELECT RAISE(ABORT, 'journal is append-only'); END;
CREATE TRIGGER journal_no_delete BEFORE DELETE ON journal BEGIN SELECT RAISE(ABORT, 'journal is append-only'); END;
COMMIT;
