"""Wrong operator tokens: an address that sends too many is told so.

The right one is let in whatever came before it, or a stranger behind the same router could lock the operators out. So
guesses are as fast as the network; a token is too long for them (laser_bot_battle.operator_token).
"""

from laser_bot_battle.token_bucket import TokenBuckets

FREE = 5  # wrong tokens of one address at once, then
PERIOD = 1.0  # s for each further one
MAX_ADDRESSES = 1000  # that are remembered


def wrong_tokens() -> TokenBuckets:
    """Those that are still answered as such, by the address that they come from."""
    return TokenBuckets(FREE, PERIOD, MAX_ADDRESSES)
