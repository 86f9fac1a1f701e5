"""Which poses identify an arm best: observability indices, exchange from many candidates, what an instrument sees."""
