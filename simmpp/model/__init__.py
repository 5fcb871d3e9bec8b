"""The paper's analytical model: times of the two classical dataflows, step by step."""
