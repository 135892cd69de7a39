"""The stability matrix: scenes, stiff and extreme, and the judgement of every method on them."""
