"""The page of an advice: its sentences, three pictures, all candidates."""
