"""rosapi's types are upstream's: other people's clients know them by their md5 sums."""

import pytest

from server.messages.types import Types

UPSTREAM = {
    "DeleteParam": "c1f3d28f1b044c871e6eff2e9fc3c667",
    "GetActionServers": "46807ba271844ac5ba4730a47556b236",
    "GetParam": "e36fd90759dbac1c5159140a7fa8c644",
    "GetParamNames": "dc7ae3609524b18034e49294a4ce670e",
    "GetTime": "556a4fb76023a469987922359d08a844",
    "HasParam": "ed3df286bd6dff9b961770f577454ea9",
    "MessageDetails": "f9c88144f6f6bd888dd99d4e0411905d",
    "NodeDetails": "e1d0ced5ab8d5edb5fc09c98eb1d46f6",
    "Nodes": "3d07bfda1268b4f76b16b7ba8a82665d",
    "Publishers": "cb37f09944e7ba1fc08ee38f7a94291d",
    "SearchParam": "dfadc39f113c1cc6d7759508d8461d5a",
    "ServiceHost": "a1b60006f8ee69637c856c94dd192f5a",
    "ServiceNode": "bd2a0a45fd7a73a86c8d6051d5a6db8a",
    "ServiceProviders": "f30b41d5e347454ae5483ee95eef5cc6",
    "ServiceRequestDetails": "f9c88144f6f6bd888dd99d4e0411905d",
    "ServiceResponseDetails": "f9c88144f6f6bd888dd99d4e0411905d",
    "ServiceType": "0e24a2dcdf70e483afc092a35a1f15f7",
    "Services": "e44a7e7bcb900acadbcc28b132378f0c",
    "ServicesForType": "93e9fe8ae5a9136008e260fe510bd2b0",
    "SetParam": "bc6ccc4a57f61779c8eaae61e9f422e0",
    "Subscribers": "cb387b68f5b29bc1456398ee8476b973",
    "TopicType": "0d30b3f53a0fd5036523a7141e524ddf",
    "Topics": "d966d98fc333fa1f3135af765eac1ba8",
    "TopicsAndRawTypes": "e1432466c8f64316723276ba07c59d12",
    "TopicsForType": "56f77ff6da756dd27c1ed16ec721072a",
}


@pytest.mark.parametrize(("name", "md5sum"), UPSTREAM.items())
def test_a_service_is_upstream_s(name: str, md5sum: str) -> None:
    assert Types().service(f"rosapi/{name}").md5sum == md5sum


def test_a_typedef_is_upstream_s() -> None:
    assert Types().message("rosapi/TypeDef").md5sum == "80597571d79bbeef6c9c4d98f30116a0"
