BEGIN TRANSACTION;
CREATE TABLE cell (id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES run, scan TEXT NOT NULL,
    variant TEXT NOT NULL, outcome TEXT NOT NULL, error TEXT NOT NULL, seconds REAL NOT NULL);
INSERT INTO "cell" VALUES(1,1,'small.xyz','default','done','',0.017304278);
INSERT INTO "cell" VALUES(2,1,'bad.xyz','default','failed','''bad.xyz'': line 1: found 2 columns; a point has at least the three numbers x, y and z',0.000271874);
CREATE TABLE cell_step (cell INTEGER NOT NULL REFERENCES cell, step INTEGER NOT NULL REFERENCES step);
INSERT INTO "cell_step" VALUES(1,1);
INSERT INTO "cell_step" VALUES(1,2);
INSERT INTO "cell_step" VALUES(1,3);
INSERT INTO "cell_step" VALUES(1,4);
INSERT INTO "cell_step" VALUES(2,5);
CREATE TABLE metric (step INTEGER NOT NULL REFERENCES step, is_fact INTEGER NOT NULL, name TEXT NOT NULL, value REAL,
    unit TEXT NOT NULL);
INSERT INTO "metric" VALUES(1,1,'points',5.0,'count');
INSERT INTO "metric" VALUES(2,0,'bin-size',8.66025403784438652099e-03,'length');
INSERT INTO "metric" VALUES(2,0,'kept',5.0,'count');
INSERT INTO "metric" VALUES(2,0,'removed',0.0,'count');
INSERT INTO "metric" VALUES(2,0,'noise',0.0,'count');
INSERT INTO "metric" VALUES(3,0,'cells',2.0,'count');
INSERT INTO "metric" VALUES(3,0,'duplicates',0.0,'count');
INSERT INTO "metric" VALUES(3,0,'hidden',0.0,'count');
INSERT INTO "metric" VALUES(4,0,'alpha',0.816496580927726,'length');
INSERT INTO "metric" VALUES(4,0,'alpha-cover',0.816496580927726,'length');
INSERT INTO "metric" VALUES(4,0,'cells',2.0,'count');
INSERT INTO "metric" VALUES(4,0,'interior-points',0.0,'count');
INSERT INTO "metric" VALUES(4,0,'uncovered-points',0.0,'count');
INSERT INTO "metric" VALUES(4,0,'triangles',6.0,'count');
INSERT INTO "metric" VALUES(4,1,'closed',1.0,'boolean');
INSERT INTO "metric" VALUES(4,1,'components',1.0,'count');
INSERT INTO "metric" VALUES(4,1,'genus',0.0,'count');
INSERT INTO "metric" VALUES(4,1,'boundary-loops',0.0,'count');
INSERT INTO "metric" VALUES(4,1,'triangles',6.0,'count');
INSERT INTO "metric" VALUES(4,1,'points',5.0,'count');
CREATE TABLE output (id INTEGER PRIMARY KEY, cell INTEGER NOT NULL REFERENCES cell, file TEXT NOT NULL,
    kind TEXT NOT NULL, outcome TEXT NOT NULL);
INSERT INTO "output" VALUES(1,1,'out/small.stl','mesh','done');
INSERT INTO "output" VALUES(2,2,'out/bad.stl','points','skipped');
CREATE TABLE output_fact (output INTEGER NOT NULL REFERENCES output, name TEXT NOT NULL, value REAL, unit TEXT NOT NULL);
INSERT INTO "output_fact" VALUES(1,'closed',1.0,'boolean');
INSERT INTO "output_fact" VALUES(1,'components',1.0,'count');
INSERT INTO "output_fact" VALUES(1,'genus',0.0,'count');
INSERT INTO "output_fact" VALUES(1,'boundary-loops',0.0,'count');
INSERT INTO "output_fact" VALUES(1,'triangles',6.0,'count');
INSERT INTO "output_fact" VALUES(1,'points',5.0,'count');
CREATE TABLE run (id INTEGER PRIMARY KEY, started TEXT NOT NULL, workflow TEXT NOT NULL, file TEXT NOT NULL,
    arguments TEXT NOT NULL, seed TEXT NOT NULL, threads INTEGER NOT NULL, version TEXT NOT NULL, machine TEXT NOT NULL);
INSERT INTO "run" VALUES(1,'2026-11-21T22:17:42Z','quickstart','quickstart.yaml','["scanmill","run","quickstart.yaml","small.xyz","bad.xyz"]','0',2,'0.1.0','a machine');
CREATE TABLE run_end (run INTEGER PRIMARY KEY REFERENCES run, ended TEXT NOT NULL, outcome TEXT NOT NULL,
    seconds REAL NOT NULL);
INSERT INTO "run_end" VALUES(1,'2026-11-21T22:17:42Z','failed',0.022155647);
CREATE TABLE step (id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES run, node INTEGER NOT NULL,
    label TEXT NOT NULL, filter TEXT NOT NULL, filter_version INTEGER NOT NULL, build TEXT NOT NULL, scan TEXT NOT NULL,
    plan_key TEXT NOT NULL, origin TEXT NOT NULL, why TEXT NOT NULL, outcome TEXT NOT NULL, error TEXT NOT NULL,
    seconds REAL NOT NULL, cpu_seconds REAL NOT NULL, peak_memory INTEGER, authored TEXT NOT NULL,
    resolved TEXT NOT NULL);
INSERT INTO "step" VALUES(1,1,0,'read','',0,'','small.xyz','1f9f3c7d0b7e8f2a54628ab2f750c3e6','ran','it was not read before','done','',0.001426927,1.42400000000000859223e-03,NULL,'{}','{}');
INSERT INTO "step" VALUES(2,1,1,'voxel-thin','voxel-thin',1,'5434ef8d963efad6f817c7c092a9efed','small.xyz','9fda29fa198bc581b8057005520f0bce','ran','it has not run on such inputs with such parameters','done','',0.005354205,3.28400000000000219513e-03,NULL,'{"bin-size":"0.5 %diag","min-points":"1","margin":"0 u"}','{"bin-size":"0.008660254037844387 u","min-points":"1","margin":"0 u"}');
INSERT INTO "step" VALUES(3,1,2,'delaunay','delaunay',1,'aa6046b0dc03739bab73b3152dbb4b36','small.xyz','0a1cf7f61d0e9e0895a5c8958b992464','ran','it has not run on such inputs with such parameters','done','',0.006321311,2.73099999999999731858e-03,NULL,'{}','{}');
INSERT INTO "step" VALUES(4,1,3,'surface','alpha-solid',1,'30d37800126fcfa8733f730190bf3ec7','small.xyz','6aeab9e3da72c64c180ec1d00d71284d','ran','it has not run on such inputs with such parameters','done','',0.003320277,2.45099999999999484945e-03,NULL,'{"alpha":"auto","search":"scan","components":"single","coverage":"100 %"}','{"alpha":"auto","search":"scan","components":"single","coverage":"100 %"}');
INSERT INTO "step" VALUES(5,1,4,'read','',0,'','bad.xyz','5c50e4a50f1b127019daa866971f3e3d','ran','it was not read before','failed','''bad.xyz'': line 1: found 2 columns; a point has at least the three numbers x, y and z',0.000271874,2.72000000000008346212e-04,NULL,'{}','{}');
CREATE TABLE warning (step INTEGER NOT NULL REFERENCES step, text TEXT NOT NULL);
CREATE INDEX step_of_run ON step (run, node);
CREATE INDEX step_by_name ON step (label, scan, run);
CREATE INDEX metric_of_step ON metric (step);
CREATE INDEX warning_of_step ON warning (step);
CREATE INDEX cell_of_run ON cell (run);
CREATE INDEX step_of_cell ON cell_step (cell);
CREATE INDEX output_of_cell ON output (cell);
CREATE INDEX fact_of_output ON output_fact (output);
COMMIT;
PRAGMA user_version = 1;
