"""The report: one self-contained HTML page with figures, made from what a run or a result file knows."""
